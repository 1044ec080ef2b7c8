"""Write `youbot_rollers.xml`: the robot of make_urdf.py for MuJoCo, on four wheels of passive rollers.

    python robots/youbot/make_mjcf.py

Masses, inertias, lengths, zero and signs are make_urdf.py's; the rotors are youbot.yaml's. What is new here
is what only a simulator needs: rollers, floor, mechanical stops, motors, servos, and a box as the obstacle.
"Assumed" marks a figure that no source gives; the sources' short names are spelled out in README.md. Units as
in make_urdf.py.
"""

import xml.etree.ElementTree as ET
from math import cos, pi, radians, sin
from pathlib import Path

import make_urdf as robot
from make_urdf import Inertial, Shape, Vector, number, triple

OUTPUT = Path(__file__).with_name("youbot_rollers.xml")

# --- Wheels ---
ROLLERS = 6  # a wheel: MAN Fig 3-4, WEB
ROLLER_MASS = 0.05  # WEB
ROLLER_RADIUS = 0.014  # WEB: at its middle
# An ellipsoid whose middle runs on a ring of this radius, its axis at 45 degrees to the wheel's. At the angle
# s from the lowest point the wheel's radius is
#   ring cos s + sqrt(radius^2 + (half length^2 - radius^2) sin^2 s / 2),
# which these two figures keep within 0.25 % of WHEEL_RADIUS over the 60 degrees that a roller carries.
RING_RADIUS = 0.03338
ROLLER_HALF_LENGTH = 0.03685
ROLLER_DAMPING = 1e-5  # assumed; from 0 to 1e-2 the motion is the same
ROLLER_ARMATURE = 1e-5  # assumed: keeps the light rollers well conditioned
WHEEL_SPEED = robot.BASE_SPEED / robot.WHEEL_RADIUS  # BRO: 16.8 rad/s, what the drive takes as a command
FRICTION = 0.8  # assumed: rubber on a floor; from 0.4 to 1.2 the motion is the same

# --- Motors ---
WHEEL_ROTOR = 0.00901  # youbot.yaml
ARM_ROTOR = (0.3285, 0.3285, 0.1350, 0.04663, 0.01764)  # youbot.yaml
# Velocity servos, proportional and integral, critically damped at this bandwidth with the inertia that each
# joint feels at most (rotor and stretched links; a wheel: a fourth of the robot). Assumed: KUKA's are not
# published.
SERVO_BANDWIDTH = 50.0  # rad/s
ARM_SERVO_INERTIA = (0.73, 0.65, 0.23, 0.064, 0.018)
WHEEL_SERVO_INERTIA = 0.026
MOTORS, SERVOS = "0", "1"  # actuator groups: one of them is switched off

# --- Stops ---
# ROS: the widest range in print. The mechanical stops lie at or beyond it, and outside the limits that the
# controller keeps (MAN), by 0.5 to 1.5 degrees.
STOPS: tuple[tuple[float, float], ...] = (
    (-169, 169),
    (-65, 90),
    (-151, 146),
    (-102.5, 102.5),
    (-167.5, 167.5),
)

# The plant adds a payload to this body; without any mass MuJoCo would misplace its centre.
NO_PAYLOAD = Inertial(1e-9, robot.ORIGIN, (1e-12, 1e-12, 1e-12))

# --- Scene ---
# A low box before the left half of the chassis. The scenarios stop base_x at 0.35 m, where the chassis'
# front, 0.29 m ahead, meets its face while the robot looks along x; turned to the left, as there, that half
# lies further back. Higher than the chassis' clearance, and below the goal.
OBSTACLE_BOX: Vector = (0.08, 0.08, 0.06)  # assumed: edges
OBSTACLE_FACE = 0.35 + 0.29
OBSTACLE_LEFT = 0.01  # y of its centre: the goal lies to the left of it
FLOOR_SIZE = 20.0


def ring_inertia() -> tuple[float, float]:
    """Inertia of a wheel's rollers about the wheel's axis, and across it.

    A roller's axis is at 45 degrees to the wheel's, so along that it has the mean of its own two moments. The
    ring has no products of inertia: they cancel around it.
    """
    own_along, own_across, _ = roller_moments()
    about = ROLLERS * (ROLLER_MASS * RING_RADIUS**2 + (own_along + own_across) / 2)
    trace = ROLLERS * (2 * ROLLER_MASS * RING_RADIUS**2 + own_along + 2 * own_across)
    return about, (trace - about) / 2


def roller_moments() -> Vector:
    """Moments of an ellipsoid of revolution: along its axis, and twice across."""
    along = ROLLER_MASS * 2 * ROLLER_RADIUS**2 / 5
    across = ROLLER_MASS * (ROLLER_RADIUS**2 + ROLLER_HALF_LENGTH**2) / 5
    return along, across, across


def hub() -> Inertial:
    """Return what is left of make_urdf.py's wheel without the rollers."""
    about, across = ring_inertia()
    x, y, z = robot.WHEEL.moments
    mass = robot.WHEEL.mass - ROLLERS * ROLLER_MASS
    return Inertial(mass, robot.ORIGIN, (x - across, y - about, z - across))


def add_body(parent: ET.Element, name: str, pos: Vector, inertial: Inertial | None = None) -> ET.Element:
    """Add a body, parallel to its parent."""
    body = ET.SubElement(parent, "body", name=name, pos=triple(pos))
    if inertial:
        moments = " ".join(number(value) for value in (*inertial.moments, 0.0, inertial.ixz, 0.0))
        ET.SubElement(
            body, "inertial", pos=triple(inertial.com), mass=number(inertial.mass), fullinertia=moments
        )
    return body


def add_shapes(body: ET.Element, shapes: tuple[Shape, ...]) -> None:
    """Add shapes that are seen and that collide with the floor and the obstacle."""
    for shape in shapes:
        geom = ET.SubElement(body, "geom", type="box" if len(shape.size) == 3 else "cylinder")
        # MuJoCo takes half edges, and a cylinder's radius with its half length
        size = shape.size if len(shape.size) == 2 else tuple(edge / 2 for edge in shape.size)
        size = size if len(size) == 3 else (size[0], size[1] / 2)
        geom.set("size", " ".join(number(edge) for edge in size))
        geom.set("pos", triple(shape.xyz))
        if shape.rpy != robot.ORIGIN:
            geom.set("euler", triple(shape.rpy))
        geom.set("rgba", robot.MATERIALS[shape.material])


def add_wheel(base: ET.Element, name: str, ahead: int, left: int) -> None:
    """Add a wheel; its lowest roller's axis points at 45 degrees to x, as on a youBot seen from below."""
    at = (ahead * robot.HALF_WHEELBASE, left * robot.HALF_TRACK, robot.WHEEL_RADIUS)
    wheel = add_body(base, f"wheel_{name}_link", at, hub())
    ET.SubElement(wheel, "joint", {"name": f"wheel_{name}", "class": "wheel"})
    ET.SubElement(wheel, "geom", {"class": "hub"})
    for i in range(ROLLERS):
        turn = 2 * pi * i / ROLLERS
        place = (-RING_RADIUS * sin(turn), 0.0, -RING_RADIUS * cos(turn))
        axis = (cos(turn), -float(ahead * left), -sin(turn))
        body = ET.SubElement(wheel, "body", name=f"roller_{name}_{i}", pos=triple(place), zaxis=triple(axis))
        ET.SubElement(body, "joint", {"name": f"roller_{name}_{i}", "class": "roller"})
        along, across, _ = roller_moments()
        ET.SubElement(
            body,
            "inertial",
            pos=triple(robot.ORIGIN),
            mass=number(ROLLER_MASS),
            diaginertia=triple((across, across, along)),
        )
        ET.SubElement(body, "geom", {"class": "roller"})


def add_arm(base: ET.Element) -> None:
    """Add the arm, the closed gripper, the frame `ee`, and in it a body for a payload, empty at first."""
    body = add_body(base, "arm_base_link", (robot.MOUNT_AHEAD, 0.0, robot.MOUNT_HEIGHT), robot.ARM_BASE)
    add_shapes(body, robot.ARM_BASE_SHAPES)
    for i, inertial in enumerate(robot.ARM_LINKS):
        body = add_body(body, f"arm_link_{i + 1}", robot.ARM_ORIGINS[i], inertial)
        lower, upper = STOPS[i]
        ET.SubElement(
            body,
            "joint",
            {
                "name": f"arm_joint_{i + 1}",
                "class": "arm",
                "axis": triple(robot.ARM_AXES[i]),
                "range": f"{number(round(radians(lower), 6))} {number(round(radians(upper), 6))}",
                "armature": number(ARM_ROTOR[i]),
                "frictionloss": number(robot.ARM_FRICTION[i]),
                "actuatorfrcrange": symmetric(robot.ARM_EFFORT[i]),
            },
        )
        add_shapes(body, robot.ARM_SHAPES[i])
    palm = add_body(body, "gripper_base_link", (0.0, 0.0, robot.FRAME_5_TO_GRIPPER), robot.GRIPPER_BASE)
    add_shapes(palm, robot.GRIPPER_BASE_SHAPES)
    for name, side in (("l", 1), ("r", -1)):
        centre = (0.0, side * robot.FINGER_BOX[1] / 2, robot.FINGER_BOX[2] / 2)
        inertial = robot.box_inertial(robot.FINGER_MASS, centre, robot.FINGER_BOX)
        mount = (0.0, side * robot.FINGER_GAP, robot.FINGER_MOUNT_HEIGHT)
        finger = add_body(palm, f"gripper_finger_{name}_link", mount, inertial)
        add_shapes(finger, (Shape(robot.FINGER_BOX, centre, "grey"),))
    tip = (0.0, 0.0, robot.GRIPPER_TO_TIP)
    ET.SubElement(palm, "site", name="ee", pos=triple(tip), size="0.005", rgba="1 0 0 1")
    add_body(palm, "payload", tip, NO_PAYLOAD)


def symmetric(bound: float) -> str:
    """Return a range about zero."""
    return f"{number(-bound)} {number(bound)}"


def add_defaults(root: ET.Element) -> None:
    """Add what geoms and joints of a kind share."""
    default = ET.SubElement(root, "default")
    # the robot meets the floor and the obstacle, not itself
    ET.SubElement(default, "geom", contype="0", conaffinity="1", condim="3")
    wheel = ET.SubElement(default, "default", {"class": "wheel"})
    ET.SubElement(
        wheel,
        "joint",
        type="hinge",
        axis="0 1 0",
        armature=number(WHEEL_ROTOR),
        actuatorfrcrange=symmetric(robot.WHEEL_EFFORT),
    )
    hub_class = ET.SubElement(default, "default", {"class": "hub"})
    ET.SubElement(
        hub_class,
        "geom",
        type="cylinder",
        size="0.022 0.036",
        euler=triple(robot.CROSSWISE),
        contype="0",
        conaffinity="0",
        rgba=robot.MATERIALS["black"],
    )
    roller = ET.SubElement(default, "default", {"class": "roller"})
    ET.SubElement(
        roller,
        "joint",
        type="hinge",
        axis="0 0 1",
        damping=number(ROLLER_DAMPING),
        armature=number(ROLLER_ARMATURE),
    )
    # no torsional friction (condim 3): with it the wheels lose 5 % sideways
    ET.SubElement(
        roller,
        "geom",
        type="ellipsoid",
        size=triple((ROLLER_RADIUS, ROLLER_RADIUS, ROLLER_HALF_LENGTH)),
        priority="1",
        friction=number(FRICTION),
        solref="0.01 1",
        solimp="0.95 0.99 0.001",
        rgba=robot.MATERIALS["yellow"],
    )
    arm = ET.SubElement(default, "default", {"class": "arm"})
    ET.SubElement(
        arm,
        "joint",
        type="hinge",
        limited="true",
        damping=number(robot.ARM_DAMPING),
        solreflimit="0.004 1",
        solimplimit="0.95 0.99 0.0001",
    )


def add_scene(world: ET.Element) -> None:
    """Add the light, the floor, and the obstacle, a box that only a scenario moves."""
    ET.SubElement(world, "light", pos="0 0 4", dir="0 0 -1", directional="true")
    ET.SubElement(
        world,
        "geom",
        name="floor",
        type="plane",
        size=f"{number(FLOOR_SIZE)} {number(FLOOR_SIZE)} 0.1",
        contype="1",
        conaffinity="0",
        rgba="0.8 0.8 0.8 1",
    )
    depth, width, height = OBSTACLE_BOX
    at = (OBSTACLE_FACE + depth / 2, OBSTACLE_LEFT, height / 2)
    box = ET.SubElement(world, "body", name="obstacle", mocap="true", pos=triple(at))
    half = triple((depth / 2, width / 2, height / 2))
    ET.SubElement(
        box,
        "geom",
        name="obstacle",
        type="box",
        size=half,
        contype="1",
        conaffinity="0",
        rgba="0.6 0.1 0.1 1",
    )


def add_actuators(root: ET.Element) -> None:
    """Add a torque motor to every driven joint, and a velocity servo of two parts.

    The servo's parts: a torque in proportion to the speed error, and one in proportion to its integral.
    """
    joints = [(f"wheel_{name}", WHEEL_SPEED, WHEEL_SERVO_INERTIA) for name in ("fl", "fr", "bl", "br")]
    joints += [(f"arm_joint_{i + 1}", robot.ARM_SPEED, ARM_SERVO_INERTIA[i]) for i in range(5)]
    actuator = ET.SubElement(root, "actuator")
    for name, _, _ in joints:
        ET.SubElement(actuator, "motor", name=f"{name}_motor", joint=name, group=MOTORS)
    for name, speed, inertia in joints:
        servo = {
            "joint": name,
            "group": SERVOS,
            "ctrllimited": "true",
            "ctrlrange": symmetric(round(speed, 6)),
        }
        kv = 2 * SERVO_BANDWIDTH * inertia
        kp = SERVO_BANDWIDTH**2 * inertia
        ET.SubElement(actuator, "velocity", {"name": f"{name}_servo", "kv": number(kv), **servo})
        ET.SubElement(
            actuator,
            "general",
            {
                "name": f"{name}_servo_integral",
                **servo,
                "dyntype": "integrator",
                "biastype": "affine",
                "gainprm": number(kp),
                "biasprm": f"0 {number(-kp)} 0",
            },
        )


def mjcf_text() -> str:
    """Return the whole model."""
    root = ET.Element("mujoco", model="youbot_rollers")
    root.append(ET.Comment(" Written by make_mjcf.py, which holds the sources: change that, not this. "))
    root.append(ET.Comment(" Actuator group 0: torque motors; group 1: velocity servos. Use one of them. "))
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    ET.SubElement(root, "option", timestep="0.001", integrator="implicitfast", cone="elliptic", impratio="10")
    add_defaults(root)
    world = ET.SubElement(root, "worldbody")
    add_scene(world)
    # the lowest rollers just touch the floor: there the wheel's radius is a little less than its mean
    height = RING_RADIUS + ROLLER_RADIUS - robot.WHEEL_RADIUS
    base = add_body(world, "base_link", (0.0, 0.0, height), robot.CHASSIS)
    ET.SubElement(base, "freejoint", name="base")
    add_shapes(base, robot.CHASSIS_SHAPES)
    for name, ahead, left in (("fl", 1, 1), ("fr", 1, -1), ("bl", -1, 1), ("br", -1, -1)):
        add_wheel(base, name, ahead, left)
    add_arm(base)
    add_actuators(root)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


if __name__ == "__main__":
    OUTPUT.write_text(mjcf_text(), encoding="utf-8", newline="\n")
    print(f"wrote {OUTPUT}")
