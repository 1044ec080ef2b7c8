/** The moment that everything on the page shows, and its playback. */
export class Clock {
  time = 0;
  playing = false;
  speed = 1;
  private readonly listeners: (() => void)[] = [];
  private last = 0;

  constructor(readonly end: number) {}

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  set(time: number): void {
    this.time = Math.min(this.end, Math.max(0, time));
    this.tell();
  }

  toggle(): void {
    this.playing = !this.playing;
    if (this.playing) {
      if (this.time >= this.end) this.time = 0;
      this.last = performance.now();
      requestAnimationFrame(this.tick);
    }
    this.tell();
  }

  private readonly tick = (now: number): void => {
    if (!this.playing) return;
    const time = this.time + (Math.max(0, now - this.last) / 1000) * this.speed;
    this.last = now;
    this.playing = time < this.end;
    this.set(time);
    requestAnimationFrame(this.tick);
  };

  private tell(): void {
    for (const listener of this.listeners) listener();
  }
}
