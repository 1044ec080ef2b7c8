import {
  BoxGeometry,
  type BufferGeometry,
  type Color,
  CylinderGeometry,
  Group,
  Mesh,
  MeshStandardMaterial,
  Quaternion,
  SphereGeometry,
  SRGBColorSpace,
  Vector3,
} from "three";
import type { JointData, SceneData, VisualData } from "./data";

/** A robot's links as a tree of groups that joints move. */
export class RobotModel {
  readonly root = new Group();
  private readonly links = new Map<string, Group>();
  private readonly joints = new Map<string, { data: JointData; child: Group }>();
  /** Materials of the first links with a shape that a joint moves. */
  private readonly moved: MeshStandardMaterial[][];
  private readonly materials: { material: MeshStandardMaterial; own: Color }[] = [];

  constructor(private readonly scene: SceneData) {
    for (const link of scene.links) {
      const group = new Group();
      for (const visual of link.visuals) group.add(this.shape(visual));
      this.links.set(link.name, group);
    }
    for (const joint of scene.tree) {
      const child = this.link(joint.child);
      this.link(joint.parent).add(child);
      this.joints.set(joint.name, { data: joint, child });
      place(child, joint, joint.locked);
    }
    for (const group of this.links.values()) if (!group.parent) this.root.add(group);
    this.moved = scene.joints.map((name) => firstMaterials(this.joint(name).child));
  }

  /** Puts the joints, in the order of the scene, to q [rad or m]. */
  pose(q: ArrayLike<number>): void {
    this.scene.joints.forEach((name, i) => {
      const { data, child } = this.joint(name);
      place(child, data, q[i] as number);
    });
    this.root.updateMatrixWorld(true);
  }

  /** Colours links as far as the limits of their joints act, each 0 to 1. */
  tint(activations: ArrayLike<number>, acting: Color): void {
    for (const { material, own } of this.materials) material.color.copy(own);
    this.moved.forEach((materials, i) => {
      const share = 0.85 * Math.min(1, Math.abs(activations[i] as number));
      for (const material of materials) material.color.lerp(acting, share);
    });
  }

  /** Makes the robot a ghost of one colour, or solid in its own colours. */
  ghost(colour: Color | null): void {
    for (const { material, own } of this.materials) {
      material.color.copy(colour ?? own);
      material.transparent = colour !== null;
      material.opacity = colour ? 0.16 : 1;
      material.depthWrite = colour === null;
    }
    this.root.traverse((each) => {
      each.castShadow = colour === null;
    });
  }

  position(link: string): Vector3 {
    return this.link(link).getWorldPosition(new Vector3());
  }

  quaternion(link: string): Quaternion {
    return this.link(link).getWorldQuaternion(new Quaternion());
  }

  private link(name: string): Group {
    const found = this.links.get(name);
    if (!found) throw new Error(`the robot has no link '${name}'`);
    return found;
  }

  private joint(name: string): { data: JointData; child: Group } {
    const found = this.joints.get(name);
    if (!found) throw new Error(`the robot has no joint '${name}'`);
    return found;
  }

  private shape(visual: VisualData): Mesh {
    const material = new MeshStandardMaterial({ roughness: 0.75, metalness: 0 });
    material.color.setRGB(...visual.colour, "srgb");
    const { h, s, l } = material.color.getHSL({ h: 0, s: 0, l: 0 }, SRGBColorSpace);
    material.color.setHSL(h, 0.3 * s, 0.16 + 0.72 * l, SRGBColorSpace); // muted, so that an acting limit stands out
    this.materials.push({ material, own: material.color.clone() });
    const mesh = new Mesh(geometry(visual), material);
    mesh.position.set(...visual.xyz);
    mesh.quaternion.set(...visual.quaternion);
    mesh.receiveShadow = true;
    return mesh;
  }
}

function geometry({ shape, size }: VisualData): BufferGeometry {
  const [a = 0, b = 0, c = 0] = size;
  if (shape === "box") return new BoxGeometry(a, b, c);
  if (shape === "sphere") return new SphereGeometry(a, 32, 16);
  return new CylinderGeometry(a, a, b, 40).rotateX(Math.PI / 2); // a URDF's cylinders stand along z
}

const turn = new Quaternion();
const axis = new Vector3();

function place(child: Group, joint: JointData, q: number): void {
  child.position.set(...joint.xyz);
  child.quaternion.set(...joint.quaternion);
  axis.set(...joint.axis);
  if (joint.type === "prismatic")
    child.position.add(axis.multiplyScalar(q).applyQuaternion(child.quaternion));
  else if (joint.type !== "fixed") child.quaternion.multiply(turn.setFromAxisAngle(axis, q));
}

/** Breadth first, so that a base joint without a shape of its own colours the base. */
function firstMaterials(group: Group): MeshStandardMaterial[] {
  for (let level = [group]; level.length; level = level.flatMap((each) => groupsIn(each))) {
    const found = level.flatMap((each) => each.children.filter((child) => child instanceof Mesh));
    if (found.length) return found.map((mesh) => mesh.material as MeshStandardMaterial);
  }
  return [];
}

function groupsIn(group: Group): Group[] {
  return group.children.filter((child): child is Group => child instanceof Group);
}
