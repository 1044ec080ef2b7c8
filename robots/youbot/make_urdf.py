"""Write `youbot.urdf`: the KUKA youBot from published figures, with primitive shapes only.

    python robots/youbot/make_urdf.py

The short source names in the comments (MAN, BRO, DRV, ...) are spelled out in README.md, which also says what
was chosen where sources disagree. "Assumed" marks a figure that no source gives. Lengths are in metres,
angles in degrees until they are written, masses in kilograms, inertias in kg m2, torques in Nm.
"""

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from math import pi, radians
from pathlib import Path

Vector = tuple[float, float, float]
ORIGIN: Vector = (0.0, 0.0, 0.0)
OUTPUT = Path(__file__).with_name("youbot.urdf")

# --- Base ---
WHEEL_RADIUS = 0.0475  # DRV and MR; MAN and BRO print a diameter of 100 mm, see README
WHEEL_WIDTH = 0.076  # MAN: 376 mm overall width less the 300 mm track
HALF_WHEELBASE = 0.235  # lx: DRV, MR (470 mm; MAN and BRO 471)
HALF_TRACK = 0.150  # ly: MAN, BRO, DRV, MR (300 mm)
WHEEL_MASS = 1.4  # MAS; KUKA prints none
PLATFORM_MASS = 20.0 + 4.0  # MAN: platform and battery, the wheels among them
CHASSIS_COM_HEIGHT = 0.075  # assumed
CHASSIS_BOX: Vector = (0.52, 0.30, 0.09)  # assumed: homogeneous box that stands for the chassis' inertia
WHEEL_INERTIA_RADIUS = 0.040  # assumed: hub and rollers as one cylinder, a little inside the rolling radius
BASE_SPEED = 0.8  # BRO [m/s]; no yaw speed is published, so the wheels' speed at 0.8 m/s sets it
BASE_RANGE = 50.0  # assumed: how far the floor goes from the origin [m]
# Nominal torque of a wheel: the motor's 0.0827 Nm (RAJ Table 3.1 has 12.90 Nm behind 156:1, and DRV's Kt says
# that the motor is the same) through the wheel's gear of 9405/364 = 25.838 (DRV).
WHEEL_EFFORT = 2.137
# Largest force and moment of four wheels at that torque, one axis at a time; together they share the wheels.
BASE_FORCE = 4.0 * WHEEL_EFFORT / WHEEL_RADIUS  # 179.96 N
BASE_MOMENT = BASE_FORCE * (HALF_WHEELBASE + HALF_TRACK)  # 69.28 Nm
# The two links that carry only x and y have no body; simulators refuse a moving link of no mass.
CARRIER_MASS = 1e-6
CARRIER_INERTIA = 1e-9

# --- Arm: geometry ---
MOUNT_AHEAD = 0.1662  # MR: axis 1 ahead of the base's centre
MOUNT_HEIGHT = 0.0963 + 0.0026  # MR: mounting plane above the floor
AXIS_2_HEIGHT = 0.147  # MAN Fig 4-2, BRO: axis 2 above the mounting plane
AXIS_2_AHEAD = 0.033  # MAN Fig 4-2, BRO: axis 2 in front of axis 1
UPPER_ARM = 0.155  # MAN Fig 4-2, BRO: axis 2 to 3
FOREARM = 0.135  # MAN Fig 4-2, BRO: axis 3 to 4
AXIS_4_TO_TIP = 0.2176  # MAN Fig 4-2; BRO prints 217.5 mm
AXIS_4_TO_5 = 0.1136  # RAJ (KUKA's CAD frames): where link 5's inertia is given
FRAME_5_TO_GRIPPER = 0.05716  # RAJ: the frame in which the gripper's inertia is given
GRIPPER_TO_TIP = AXIS_4_TO_TIP - AXIS_4_TO_5 - FRAME_5_TO_GRIPPER

# --- Arm: limits ---
# MAN, the narrowest range in print: BRO and ROS are up to 1.5 deg wider. Zero is straight up.
ARM_RANGE: tuple[tuple[float, float], ...] = ((-168, 168), (-64, 89), (-150, 145), (-102, 102), (-166, 166))
ARM_SPEED = pi / 2  # MAN, BRO: 90 deg/s, every axis
# Nominal motor torque through the gear, losses left out: RAJ Table 3.1, from KUKA's detailed specifications.
# The 9.5, 9.5, 6, 2, 1 Nm of ROS and WEB cannot be meant: holding the arm stretched forward takes 9.78 Nm at
# joint 2 without a load, and 12.27 Nm with the payload of 0.5 kg.
ARM_EFFORT = (12.9, 12.9, 8.27, 4.17, 1.755)
ARM_FRICTION = (1.008, 0.765, 0.389, 0.240, 0.142)  # RAJ: Coulomb friction while moving, one robot, by trial
ARM_DAMPING = 0.1  # assumed [Nm s/rad]
# What the KUKA driver adds to our joint positions: UZH, ITMO [deg].
DRIVER_OFFSET = (169.0, 65.0, -146.0, 102.5, 167.5)

# --- Gripper ---
FINGER_TRAVEL = 0.0115  # DRV; MAN prints 10 mm a jaw
FINGER_SPEED = 0.1  # assumed [m/s]
FINGER_EFFORT = 20.0  # assumed: KUKA prints no grip force [N]
FINGER_DAMPING = 1.0  # assumed [N s/m]
FINGER_FRICTION = 0.5  # assumed [N]
FINGER_MASS = 0.010  # RAJ
FINGER_BOX: Vector = (0.014, 0.008, 0.045)  # assumed
FINGER_MOUNT_HEIGHT = 0.012  # assumed
FINGER_GAP = 0.001  # assumed: half of what is left between closed fingers

MATERIALS = {
    "orange": "1 0.4 0 1",
    "dark": "0.2 0.2 0.2 1",
    "grey": "0.6 0.6 0.6 1",
    "black": "0.05 0.05 0.05 1",
    "yellow": "0.95 0.75 0.1 1",
}


@dataclass(frozen=True)
class Inertial:
    """Mass [kg], centre of mass [m] and inertia about it [kg m2], in axes parallel to the link's frame."""

    mass: float
    com: Vector
    moments: Vector
    ixz: float = 0.0


@dataclass(frozen=True)
class Shape:
    """A box (its three edges) or a cylinder (radius and length, along z before `rpy`) on a link [m, rad]."""

    size: tuple[float, ...]
    xyz: Vector
    material: str
    rpy: Vector = ORIGIN


@dataclass(frozen=True)
class Limit:
    """Effort [N or Nm], speed [m/s or rad/s] and range [m or rad]; a continuous joint has no range."""

    effort: float
    velocity: float
    lower: float | None = None
    upper: float | None = None


def box_inertial(mass: float, com: Vector, size: Vector) -> Inertial:
    """Inertia of a homogeneous box."""
    x, y, z = (edge * edge * mass / 12 for edge in size)
    return Inertial(mass, com, (y + z, x + z, x + y))


def cylinder_inertial(mass: float, com: Vector, radius: float, length: float, axis: str) -> Inertial:
    """Inertia of a homogeneous cylinder about the axis "y" or "z"."""
    along = mass * radius * radius / 2
    across = mass * (3 * radius * radius + length * length) / 12
    return Inertial(mass, com, (across, along, across) if axis == "y" else (across, across, along))


CROSSWISE: Vector = (pi / 2, 0.0, 0.0)  # turns a cylinder's axis from z to y

CHASSIS = box_inertial(PLATFORM_MASS - 4 * WHEEL_MASS, (0.0, 0.0, CHASSIS_COM_HEIGHT), CHASSIS_BOX)
WHEEL = cylinder_inertial(WHEEL_MASS, ORIGIN, WHEEL_INERTIA_RADIUS, WHEEL_WIDTH, "y")
# Mass: RAJ (KUKA's magnesium arm), as all arm masses and tensors below; this tensor and centre are assumed.
ARM_BASE = cylinder_inertial(0.961, (0.0, 0.0, 0.04), 0.075, 0.08, "z")
# RAJ gives centres and principal moments in KUKA's joint frames, principal axes turned by Rx(C) Ry(B) Rz(A).
# Here they are in axes parallel to base_link while the arm stands straight up, the origin on each joint.
ARM_LINKS = (
    Inertial(1.390, (0.01516, -0.00359, -0.03105), (0.0032952, 0.0060091, 0.0055394), ixz=-0.0009416),
    Inertial(1.318, (0.015, -0.01903, 0.11397), (0.0031631, 0.0031145, 0.0005843)),
    # As published, the smallest moment of links 3 and 5 lies across the link; it is put along it here.
    Inertial(0.821, (-0.00013, 0.02022, 0.10441), (0.00172767, 0.0018468, 0.00041967)),
    Inertial(0.769, (-0.00015, -0.02464, 0.05353), (0.0006764, 0.000661, 0.0010573)),
    # RAJ. UZH has +16.48 mm; the minus puts the centre 97 mm from axis 4, and in ROS's model it is at 96 mm.
    Inertial(0.687, (0.0, -0.0012, -0.01648), (0.0001934, 0.0001602, 0.0000689)),
)
# RAJ and UZH have the palm's centre 28.9 mm past its frame, in the air between the fingers; 8.9 mm: assumed.
GRIPPER_BASE = Inertial(0.199, (0.0, 0.0, 0.0089), (0.0002324, 0.0002067, 0.0003629))
CARRIER = Inertial(CARRIER_MASS, ORIGIN, (CARRIER_INERTIA, CARRIER_INERTIA, CARRIER_INERTIA))

# Assumed shapes, kept within the base's 580 x 376 x 140 mm (MAN, BRO) and about the arm's axes.
CHASSIS_SHAPES = (
    Shape((0.58, 0.22, 0.11), (0.0, 0.0, 0.085), "dark"),
    Shape((0.34, 0.36, 0.106), (0.0, 0.0, 0.085), "dark"),
)
WHEEL_SHAPES = (Shape((WHEEL_RADIUS, WHEEL_WIDTH), ORIGIN, "yellow", CROSSWISE),)
ARM_BASE_SHAPES = (Shape((0.086, 0.08), (0.0, 0.0, 0.04), "black"),)
ARM_SHAPES = (
    (
        Shape((0.07, 0.07), (0.0, 0.0, -0.032), "orange"),
        Shape((0.036, 0.05), (AXIS_2_AHEAD, 0.025, 0.0), "orange", CROSSWISE),
    ),
    (Shape((0.07, 0.06, 0.22), (0.0, -0.03, 0.078), "orange"),),
    (Shape((0.06, 0.045, 0.19), (0.0, 0.0225, 0.068), "orange"),),
    (
        Shape((0.055, 0.09, 0.075), (0.0, -0.005, 0.06), "orange"),
        Shape((0.027, 0.05), (0.0, -0.022, 0.0), "orange", CROSSWISE),
    ),
    (Shape((0.028, 0.05), (0.0, 0.0, 0.01), "black"),),
)
GRIPPER_BASE_SHAPES = (Shape((0.05, 0.09, 0.035), (0.0, 0.0, -0.005), "black"),)

ARM_ORIGINS: tuple[Vector, ...] = (
    (0.0, 0.0, AXIS_2_HEIGHT),
    (AXIS_2_AHEAD, 0.0, 0.0),
    (0.0, 0.0, UPPER_ARM),
    (0.0, 0.0, FOREARM),
    (0.0, 0.0, AXIS_4_TO_5),
)
# MAN Fig 4-1: seen from above, axes 1 and 5 turn clockwise; axes 2 to 4 lean forward.
ARM_AXES: tuple[Vector, ...] = ((0, 0, -1), (0, 1, 0), (0, 1, 0), (0, 1, 0), (0, 0, -1))


def number(value: float) -> str:
    """Ten significant digits, and no negative zero."""
    return f"{value + 0.0:.10g}"


def triple(values: Vector) -> str:
    """Three numbers as URDF writes a vector."""
    return " ".join(number(value) for value in values)


def add_origin(parent: ET.Element, xyz: Vector, rpy: Vector) -> None:
    """Add the pose of a shape or a joint in its parent."""
    ET.SubElement(parent, "origin", xyz=triple(xyz), rpy=triple(rpy))


def add_link(
    robot: ET.Element, name: str, inertial: Inertial | None = None, shapes: tuple[Shape, ...] = ()
) -> None:
    """Add a link; each shape serves both to be seen and to collide."""
    link = ET.SubElement(robot, "link", name=name)
    if inertial:
        element = ET.SubElement(link, "inertial")
        add_origin(element, inertial.com, ORIGIN)
        ET.SubElement(element, "mass", value=number(inertial.mass))
        ixx, iyy, izz = (number(moment) for moment in inertial.moments)
        ixz = number(inertial.ixz)
        ET.SubElement(element, "inertia", ixx=ixx, ixy="0", ixz=ixz, iyy=iyy, iyz="0", izz=izz)
    for shape in shapes:
        for use in ("visual", "collision"):
            element = ET.SubElement(link, use)
            add_origin(element, shape.xyz, shape.rpy)
            geometry = ET.SubElement(element, "geometry")
            if len(shape.size) == 3:
                ET.SubElement(geometry, "box", size=triple(shape.size))
            else:
                radius, length = (number(edge) for edge in shape.size)
                ET.SubElement(geometry, "cylinder", radius=radius, length=length)
            if use == "visual":
                ET.SubElement(element, "material", name=shape.material)


def add_joint(
    robot: ET.Element,
    name: str,
    kind: str,
    parent: str,
    child: str,
    *,
    xyz: Vector = ORIGIN,
    axis: Vector | None = None,
    limit: Limit | None = None,
    dynamics: tuple[float, float] | None = None,
) -> None:
    """Add a joint; `dynamics` is viscous damping and Coulomb friction. No joint frame here is turned."""
    joint = ET.SubElement(robot, "joint", name=name, type=kind)
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    add_origin(joint, xyz, ORIGIN)
    if axis:
        ET.SubElement(joint, "axis", xyz=triple(axis))
    if limit:
        figures = {
            "lower": limit.lower,
            "upper": limit.upper,
            "effort": limit.effort,
            "velocity": limit.velocity,
        }
        # A millionth is far below what any source resolves, and keeps the file readable.
        written = {key: number(round(value, 6)) for key, value in figures.items() if value is not None}
        ET.SubElement(joint, "limit", written)
    if dynamics:
        damping, friction = (number(figure) for figure in dynamics)
        ET.SubElement(joint, "dynamics", damping=damping, friction=friction)


def add_base(robot: ET.Element) -> None:
    """Add the planar base (base_x, base_y, base_yaw) and its four wheels, which do not turn in this model."""
    force = Limit(BASE_FORCE, BASE_SPEED, -BASE_RANGE, BASE_RANGE)
    moment = Limit(BASE_MOMENT, BASE_SPEED / (HALF_WHEELBASE + HALF_TRACK))
    add_link(robot, "world")
    add_link(robot, "base_x_link", CARRIER)
    add_link(robot, "base_y_link", CARRIER)
    add_joint(robot, "base_x", "prismatic", "world", "base_x_link", axis=(1, 0, 0), limit=force)
    add_joint(robot, "base_y", "prismatic", "base_x_link", "base_y_link", axis=(0, 1, 0), limit=force)
    add_joint(robot, "base_yaw", "continuous", "base_y_link", "base_link", axis=(0, 0, 1), limit=moment)
    add_link(robot, "base_link", CHASSIS, CHASSIS_SHAPES)
    for name, ahead, left in (("fl", 1, 1), ("fr", 1, -1), ("bl", -1, 1), ("br", -1, -1)):
        xyz = (ahead * HALF_WHEELBASE, left * HALF_TRACK, WHEEL_RADIUS)
        add_link(robot, f"wheel_{name}_link", WHEEL, WHEEL_SHAPES)
        add_joint(robot, f"wheel_{name}_mount", "fixed", "base_link", f"wheel_{name}_link", xyz=xyz)


def add_arm(robot: ET.Element) -> None:
    """Add the arm's base and its five joints, each link named after the joint that moves it."""
    add_link(robot, "arm_base_link", ARM_BASE, ARM_BASE_SHAPES)
    add_joint(robot, "arm_mount", "fixed", "base_link", "arm_base_link", xyz=(MOUNT_AHEAD, 0.0, MOUNT_HEIGHT))
    parent = "arm_base_link"
    for i, (lower, upper) in enumerate(ARM_RANGE):
        child = f"arm_link_{i + 1}"
        limit = Limit(ARM_EFFORT[i], ARM_SPEED, radians(lower), radians(upper))
        dynamics = (ARM_DAMPING, ARM_FRICTION[i])
        add_link(robot, child, ARM_LINKS[i], ARM_SHAPES[i])
        add_joint(
            robot,
            f"arm_joint_{i + 1}",
            "revolute",
            parent,
            child,
            xyz=ARM_ORIGINS[i],
            axis=ARM_AXES[i],
            limit=limit,
            dynamics=dynamics,
        )
        parent = child


def add_gripper(robot: ET.Element) -> None:
    """Add the palm, two fingers that open to the left and the right, and the frame `ee` at the tip."""
    palm = "gripper_base_link"
    limit = Limit(FINGER_EFFORT, FINGER_SPEED, 0.0, FINGER_TRAVEL)
    dynamics = (FINGER_DAMPING, FINGER_FRICTION)
    add_link(robot, palm, GRIPPER_BASE, GRIPPER_BASE_SHAPES)
    add_joint(robot, "gripper_mount", "fixed", "arm_link_5", palm, xyz=(0.0, 0.0, FRAME_5_TO_GRIPPER))
    for name, side in (("l", 1), ("r", -1)):
        centre = (0.0, side * FINGER_BOX[1] / 2, FINGER_BOX[2] / 2)
        child = f"gripper_finger_{name}_link"
        mount = (0.0, side * FINGER_GAP, FINGER_MOUNT_HEIGHT)
        inertial = box_inertial(FINGER_MASS, centre, FINGER_BOX)
        add_link(robot, child, inertial, (Shape(FINGER_BOX, centre, "grey"),))
        add_joint(
            robot,
            f"gripper_finger_joint_{name}",
            "prismatic",
            palm,
            child,
            xyz=mount,
            axis=(0, side, 0),
            limit=limit,
            dynamics=dynamics,
        )
    add_link(robot, "ee")
    add_joint(robot, "ee_mount", "fixed", palm, "ee", xyz=(0.0, 0.0, GRIPPER_TO_TIP))


def urdf_text() -> str:
    """Return the whole URDF."""
    offset = ", ".join(f"{radians(angle):.6f}" for angle in DRIVER_OFFSET)
    robot = ET.Element("robot", name="youbot")
    robot.append(ET.Comment(" Written by make_urdf.py, which holds the sources: change that, not this. "))
    robot.append(ET.Comment(" base_link: on the floor, midway between the wheels; x forward, y left, z up. "))
    robot.append(ET.Comment(" Arm zero: straight up. Joints 1, 5 turn about -z, 2 to 4 about +y (forward). "))
    robot.append(ET.Comment(f" q_driver = q + [{offset}] rad. "))
    for name, rgba in MATERIALS.items():
        ET.SubElement(ET.SubElement(robot, "material", name=name), "color", rgba=rgba)
    add_base(robot)
    add_arm(robot)
    add_gripper(robot)
    ET.indent(robot)
    return '<?xml version="1.0"?>\n' + ET.tostring(robot, encoding="unicode") + "\n"


if __name__ == "__main__":
    OUTPUT.write_text(urdf_text(), encoding="utf-8", newline="\n")
    print(f"wrote {OUTPUT}")
