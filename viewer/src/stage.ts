import {
  AmbientLight,
  Box3,
  BoxGeometry,
  Color,
  CylinderGeometry,
  DirectionalLight,
  Fog,
  GridHelper,
  Group,
  HemisphereLight,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  PCFShadowMap,
  PerspectiveCamera,
  PlaneGeometry,
  Scene,
  ShadowMaterial,
  SphereGeometry,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import type { Clock } from "./clock";
import type { SceneData } from "./data";
import { Replay } from "./replay";
import { RobotModel } from "./robot_model";
import type { Runs } from "./runs";
import type { Theme } from "./theme";

interface Actor {
  replay: Replay;
  robot: RobotModel;
  trace: Line2;
}

/** The replay in 3D. Draws only when something changed. */
export class Stage {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(32, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private readonly actors: Actor[];
  private readonly goals = new Group();
  private readonly obstacles: { joint: number; material: MeshStandardMaterial }[] = [];
  private readonly shadow = new ShadowMaterial();
  private grid = new GridHelper();
  private stale = false;
  private size = 1; // of what the robot sweeps [m]

  constructor(
    private readonly box: HTMLElement,
    private readonly data: SceneData,
    private readonly clock: Clock,
    private readonly runs: Runs,
    private readonly theme: Theme,
  ) {
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    box.append(this.renderer.domElement);
    this.actors = data.runs.map((run) => this.actor(new Replay(run, data.joints.length)));
    this.addObstacles();
    this.scene.add(this.goals);
    this.addLightAndFloor();
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableDamping = false;
    this.controls.maxPolarAngle = 0.495 * Math.PI;
    this.controls.addEventListener("change", () => this.refresh());
    this.lookAtAll();
    new ResizeObserver(() => this.resize()).observe(box);
    clock.onChange(() => this.refresh());
    runs.onChange(() => this.dress());
    theme.onChange(() => this.dress());
    this.dress();
  }

  /** The robot of a run, posed for the clock's time. */
  robot(run: number): RobotModel {
    const actor = this.actors[run];
    if (!actor) throw new Error(`there is no run number ${run}`);
    actor.robot.pose(actor.replay.positions(this.clock.time));
    return actor.robot;
  }

  /** Signed activations of the run in front: positive for upper limits. */
  activations(): Float32Array {
    return (this.actors[this.runs.front] as Actor).replay.activations(this.clock.time);
  }

  goalPosition(frame: string): Vector3 | null {
    const { replay } = this.actors[this.runs.front] as Actor;
    const goal = replay.goals.find((each) => each.frame === frame);
    return goal ? goal.position(replay.frame(this.clock.time)) : null;
  }

  /** Looks at the whole scene again. */
  lookAtAll(): void {
    const reach = new Box3();
    for (const { robot, replay } of this.actors) {
      robot.pose(replay.positions(0));
      reach.expandByObject(robot.root);
      robot.pose(replay.positions(this.clock.end));
      reach.expandByObject(robot.root);
    }
    const centre = reach.getCenter(new Vector3());
    this.size = Math.max(0.3, reach.getSize(new Vector3()).length());
    this.controls.target.copy(centre).setZ(centre.z * 0.85);
    this.camera.position
      .set(0.75, -1.15, 0.62)
      .normalize()
      .multiplyScalar(1.5 * this.size)
      .add(centre);
    this.camera.near = 0.01 * this.size;
    this.camera.far = 30 * this.size;
    this.controls.update();
    this.resize();
  }

  private actor(replay: Replay): Actor {
    const robot = new RobotModel(this.data);
    const geometry = new LineGeometry();
    geometry.setPositions(replay.trace);
    const trace = new Line2(geometry, new LineMaterial({ linewidth: 2 })); // pixels
    trace.frustumCulled = false;
    this.scene.add(robot.root, trace);
    return { replay, robot, trace };
  }

  private addObstacles(): void {
    for (const obstacle of this.data.obstacles) {
      const material = new MeshStandardMaterial({ transparent: true, opacity: 0.72, roughness: 0.9 });
      const mesh = new Mesh(new BoxGeometry(...obstacle.size), material);
      mesh.position.set(...obstacle.xyz);
      mesh.castShadow = true;
      this.scene.add(mesh);
      this.obstacles.push({ joint: this.data.joints.indexOf(obstacle.joint), material });
    }
  }

  private addLightAndFloor(): void {
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(1.2, -1.6, 3);
    sun.castShadow = true;
    sun.shadow.mapSize.set(1024, 1024);
    sun.shadow.radius = 4;
    sun.shadow.bias = -0.0004;
    sun.shadow.normalBias = 0.01;
    Object.assign(sun.shadow.camera, { left: -2, right: 2, top: 2, bottom: -2, near: 0.1, far: 8 });
    const floor = new Mesh(new PlaneGeometry(40, 40), this.shadow);
    floor.receiveShadow = true;
    this.scene.add(new AmbientLight(0xffffff, 0.5), new HemisphereLight(0xffffff, 0x99a0a8, 1.6), sun, floor);
  }

  /** Colours for the theme, who is in front, who is shown. */
  private dress(): void {
    const { palette } = this.theme;
    this.scene.background = new Color(palette.stage);
    this.scene.fog = new Fog(palette.stage, 2 * this.size, 5 * this.size);
    this.shadow.opacity = this.theme.name === "dark" ? 0.45 : 0.18;
    this.scene.remove(this.grid);
    this.grid.dispose();
    this.grid = new GridHelper(6, 24, palette.floor, palette.floor);
    this.grid.rotation.x = Math.PI / 2;
    this.grid.material.transparent = true;
    this.grid.material.opacity = 0.55;
    this.scene.add(this.grid);
    this.actors.forEach(({ robot, trace }, run) => {
      const shown = this.runs.shown(run);
      const front = run === this.runs.front;
      robot.root.visible = shown && (front || this.runs.ghosts);
      robot.ghost(front ? null : new Color(this.theme.curve(run)));
      trace.visible = shown;
      trace.material.color.set(this.runs.count > 1 ? this.theme.curve(run) : palette.trace);
    });
    this.showGoals();
    this.refresh();
  }

  /** Frames for the goals of the run in front. */
  private showGoals(): void {
    this.goals.clear();
    for (const goal of (this.actors[this.runs.front] as Actor).replay.goals) {
      const ball = new Mesh(
        new SphereGeometry(0.014, 24, 12),
        new MeshBasicMaterial({
          color: this.theme.palette.curves[2] as string,
          transparent: true,
          opacity: 0.85,
        }),
      );
      const marker = new Group().add(ball);
      if (goal.quaternion(0)) {
        marker.add(...axes());
      }
      this.goals.add(marker);
    }
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // a tall box sees as much from side to side as a square one
    this.camera.fov =
      this.camera.aspect < 1
        ? (2 * Math.atan(Math.tan(Math.PI / 11.25) / this.camera.aspect) * 180) / Math.PI
        : 32;
    this.camera.updateProjectionMatrix();
    this.refresh();
  }

  private refresh(): void {
    if (this.stale) return;
    this.stale = true;
    requestAnimationFrame(() => this.draw());
  }

  private draw(): void {
    this.stale = false;
    const { time } = this.clock;
    const acting = new Color(this.theme.palette.acting);
    this.actors.forEach(({ robot, replay }, run) => {
      if (!robot.root.visible) return;
      robot.pose(replay.positions(time));
      if (run === this.runs.front) robot.tint(replay.activations(time), acting);
    });
    const { replay } = this.actors[this.runs.front] as Actor;
    this.goals.children.forEach((marker, i) => {
      const goal = replay.goals[i];
      if (!goal) return;
      marker.position.copy(goal.position(replay.frame(time)));
      const quaternion = goal.quaternion(replay.frame(time));
      if (quaternion) marker.quaternion.copy(quaternion);
    });
    const activations = replay.activations(time);
    for (const { joint, material } of this.obstacles) {
      material.color.set(this.theme.palette.obstacle).lerp(acting, Math.abs(activations[joint] ?? 0));
    }
    this.renderer.render(this.scene, this.camera);
  }
}

const AXIS = { length: 0.11, radius: 0.0035 }; // of a goal frame [m]

/** Rods along x, y and z: red, green and blue as usual, in shades that the colour-blind can tell apart. */
function axes(): Mesh[] {
  return ["#d55e00", "#009e73", "#0072b2"].map((color, i) => {
    const rod = new Mesh(
      new CylinderGeometry(AXIS.radius, AXIS.radius, AXIS.length).translate(0, AXIS.length / 2, 0),
      new MeshBasicMaterial({ color }),
    );
    if (i === 0) rod.rotation.z = -Math.PI / 2;
    if (i === 2) rod.rotation.x = Math.PI / 2;
    return rod;
  });
}
