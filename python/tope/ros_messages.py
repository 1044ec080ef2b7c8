"""Definitions of the ROS 2 messages that an export holds, as MCAP wants them: each with all it is made of.

Fields after ros2/common_interfaces and ros2/geometry2.
"""

from __future__ import annotations

TIME = "int32 sec\nuint32 nanosec"
HEADER = "builtin_interfaces/Time stamp\nstring frame_id"
VECTOR3 = "float64 x\nfloat64 y\nfloat64 z"
QUATERNION = "float64 x\nfloat64 y\nfloat64 z\nfloat64 w"

PARTS = {
    "builtin_interfaces/Time": TIME,
    "std_msgs/Header": HEADER,
    "geometry_msgs/Vector3": VECTOR3,
    "geometry_msgs/Point": VECTOR3,
    "geometry_msgs/Quaternion": QUATERNION,
    "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation",
    "geometry_msgs/TransformStamped": (
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform"
    ),
    "diagnostic_msgs/KeyValue": "string key\nstring value",
    "diagnostic_msgs/DiagnosticStatus": (
        "byte level\nstring name\nstring message\nstring hardware_id\ndiagnostic_msgs/KeyValue[] values"
    ),
}

MESSAGES = {
    "std_msgs/msg/String": "string data",
    "sensor_msgs/msg/JointState": (
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort"
    ),
    "geometry_msgs/msg/PoseStamped": "std_msgs/Header header\ngeometry_msgs/Pose pose",
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "diagnostic_msgs/msg/DiagnosticArray": (
        "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status"
    ),
}


def definition(name: str) -> str:
    """A message's definition, followed by those of the messages inside it."""
    found = [MESSAGES[name]]
    parts: list[str] = []
    for text in found:
        for field in text.splitlines():
            part = field.split()[0].removesuffix("[]")
            if part in PARTS and part not in parts:
                parts.append(part)
                found.append(PARTS[part])
    return MESSAGES[name] + "".join(f"\n{'=' * 80}\nMSG: {part}\n{PARTS[part]}" for part in parts)
