"""Makes the pictures of this folder from real runs: `make pictures`."""

from __future__ import annotations

import io
import tempfile
import time
from pathlib import Path

from browser import Browser, Page
from PIL import Image

from tope import play
from tope.compare import compare
from tope.session import Session
from tope.simulation import simulate

DOCS = Path(__file__).parent
VELOCITY = DOCS.parent / "scenarios/youbot_velocity.yaml"
POTENTIAL_FIELD = DOCS.parent / "scenarios/youbot_potential_field.yaml"
LAPTOP = {"width": 1280, "height": 800}
PHONE = {"width": 390, "height": 844, "scale": 1.5}
STRIP = {"width": 1280, "height": 620}  # of the animation
ANIMATED, FRAME_RATE = 4.0, 12  # [s], [1/s]
MOMENT = 1.35  # the second limit acts, the first begins to [s]
TO_REPLAY = "document.querySelector('.desk').scrollIntoView()"
TO_ACTIVATIONS = "document.getElementById('section-3').scrollIntoView()"
TO_PLOTS = "document.getElementById('section-1').scrollIntoView()"


def main() -> None:
    """Make all pictures."""
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        simulate(VELOCITY, out=scratch / "run")
        methods = ["unilateral", "chain", "switch"]
        compare(VELOCITY, others=[POTENTIAL_FIELD], limits=methods, out=scratch / "compare")
        browser = Browser(scratch)
        for name, page in (
            ("report", opened(browser, scratch / "run", LAPTOP)),
            ("report-dark", opened(browser, scratch / "run", {**LAPTOP, "dark": True}, TO_PLOTS)),
            ("report-phone", opened(browser, scratch / "run", PHONE, TO_REPLAY)),
            ("report-compare", opened(browser, scratch / "compare", LAPTOP, TO_REPLAY)),
        ):
            save(name, page.picture())
            page.close()
        animate(opened(browser, scratch / "run", STRIP, TO_ACTIVATIONS))
        save("play", live_page(browser))
        browser.close()


def opened(browser: Browser, folder: Path, view: dict[str, float | bool], scroll: str = "0") -> Page:
    """A report at its most telling moment."""
    page = browser.open((folder / "report.html").as_uri(), **view)
    page.run(f"{scroll}; tope.setTime({MOMENT})")
    page.settle(5)
    return page


def live_page(browser: Browser) -> bytes:
    """The live page after a few seconds."""
    session = Session(VELOCITY, {})
    live = play.Page(session, "127.0.0.1", 0)
    tab = browser.open(live.address, **LAPTOP)
    tab.wait_for("document.body.innerText.includes('limits.method')", seconds=30)
    time.sleep(5)
    tab.run("document.querySelector('.mantine-Notification-closeButton')?.click()")
    time.sleep(1)
    picture = tab.picture()
    tab.close()
    live.close()
    session.close()
    return picture


def animate(page: Page) -> None:
    """The replay beside the plots, as an animation."""
    frames = []
    for i in range(round(ANIMATED * FRAME_RATE) + 1):
        page.run(f"tope.setTime({i / FRAME_RATE})")
        frames.append(Image.open(io.BytesIO(page.picture())).convert("RGB"))
    pause = [1000 // FRAME_RATE] * (len(frames) - 1) + [1500]
    settings = {"save_all": True, "duration": pause, "loop": 0, "quality": 60, "method": 6}
    frames[0].save(DOCS / "replay.webp", append_images=frames[1:], **settings)
    page.close()


def save(name: str, png: bytes) -> None:
    """Save a picture with few colours, which keeps it small; the most frequent ones stay as they are."""
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    counted = sorted(picture.getcolors(picture.width * picture.height), reverse=True)
    frequent = [channel for _, colour in counted[:16] for channel in colour]
    others = picture.quantize(240, method=Image.Quantize.FASTOCTREE).getpalette()
    palette = Image.new("P", (1, 1))
    palette.putpalette(frequent + others)
    picture.quantize(palette=palette, dither=Image.Dither.NONE).save(DOCS / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
