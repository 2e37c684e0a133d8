"""Robot files that a user might write: the official UR10 and Panda, with their meshes.

Both come from the wheel `example-robot-data`; only what a robot file needs and the URDF lacks is
added: a gripper for the UR10 (ours, from robots/ur10_ag95), a frame between the Panda's pads.
"""

import json
import shutil
import sys
import sysconfig
import xml.etree.ElementTree as ElementTree
from pathlib import Path

PACKAGE = "example-robot-data"
"""What `package://` in the official URDFs names."""
OUR_UR10 = Path(__file__).parents[2] / "robots" / "ur10_ag95"


def package_folder() -> Path:
    """The folder of the wheel's data, which holds `robots/`."""
    for root in map(Path, [sysconfig.get_paths()["purelib"], *sys.path]):
        folder = root / "cmeel.prefix" / "share" / PACKAGE
        if (folder / "robots").is_dir():
            return folder
    raise FileNotFoundError("install the wheel example-robot-data: see requirements.txt")


def copy_meshes(folder: Path, description: str, *meshes: str) -> None:
    """The robot's meshes, below `folder`/data as the package has them."""
    for mesh in meshes:
        relative = Path("robots") / description / "meshes" / mesh
        shutil.copytree(package_folder() / relative, folder / "data" / relative)


def official_urdf(description: str, name: str) -> str:
    path = package_folder() / "robots" / description / "urdf" / name
    return path.read_text(encoding="utf-8")


def with_elements(urdf: str, elements: list[str]) -> str:
    """The URDF text with more elements before its end."""
    head, _, tail = urdf.rpartition("</robot>")
    return "\n".join([head, *elements, "</robot>" + tail])


def below(urdf: str, joint: str) -> list[str]:
    """The joint of that name, and every link and joint below it, as text."""
    robot = ElementTree.fromstring(urdf)
    joints = {j.get("name"): j for j in robot.findall("joint")}
    links = {link.get("name"): link for link in robot.findall("link")}
    found, border = [], [joint]
    while border:
        element = joints[border.pop()]
        child = element.find("child").get("link")
        found += [element, links[child]]
        border += [n for n, j in joints.items() if j.find("parent").get("link") == child]
    return [ElementTree.tostring(element, encoding="unicode") for element in found]


def write_robot(folder: Path, urdf: str, keys: dict, packages: bool = True) -> Path:
    """Writes robot.urdf and robot.yaml (JSON values line by line) into `folder`."""
    (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
    keys = {"format": "clearway-robot/1", "urdf": "robot.urdf", **keys}
    if packages:
        keys["packages"] = {PACKAGE: "data"}
    lines = [f"{key}: {json.dumps(value)}" for key, value in keys.items()]
    (folder / "robot.yaml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder / "robot.yaml"


UR10_KEYS = {
    "arm": {"base": "base_link", "tip": "tool0"},
    "home": {
        "shoulder_pan_joint": 0.0,
        "shoulder_lift_joint": -2.273,
        "elbow_joint": 2.148,
        "wrist_1_joint": 0.125,
        "wrist_2_joint": 1.5708,
        "wrist_3_joint": 0.0,
    },
    "limits": {"acceleration": 8.0, "jerk": 80.0},
    "hand": {
        "kind": "parallel",
        "frame": "grasp_center",
        "joint": "finger_joint",
        "opening": {"0.0": 0.095, "0.1": 0.080689, "0.2": 0.066046, "0.3": 0.051219,
                    "0.4": 0.036354, "0.5": 0.0216, "0.6": 0.007105, "0.65": 0.0},
        "links": ["gripper_base_link", "left_knuckle", "right_knuckle", "left_finger",
                  "right_finger"],
        "base_radius": 0.06,
        "finger_thickness": 0.012,
    },
    "grasps": {"kind": "side", "yaws": 24, "heights": [0.35, 0.5, 0.65], "standoff": 0.10},
}  # fmt: skip


def official_ur10(folder: Path, packages: bool = True) -> Path:
    """The official UR10 with meshes and our AG-95; returns the robot file."""
    ours = (OUR_UR10 / "ur10_ag95.urdf").read_text(encoding="utf-8")
    urdf = official_urdf("ur_description", "ur10_robot.urdf")
    copy_meshes(folder, "ur_description", "ur10")
    urdf = with_elements(urdf, below(ours, "gripper_mount_joint"))
    return write_robot(folder, urdf, UR10_KEYS, packages)


PANDA_KEYS = {
    "arm": {"base": "panda_link0", "tip": "panda_link8"},
    "home": {
        "panda_joint1": 0.0,
        "panda_joint2": -0.785,
        "panda_joint3": 0.0,
        "panda_joint4": -2.356,
        "panda_joint5": 0.0,
        "panda_joint6": 1.571,
        "panda_joint7": 0.785,
    },
    "limits": {"acceleration": 5.0, "jerk": 80.0},
    "hand": {
        "kind": "parallel",
        "frame": "grasp_center",
        "joint": "panda_finger_joint1",
        "opening": {"0.0": 0.0, "0.04": 0.08},
        "links": ["panda_hand", "panda_leftfinger", "panda_rightfinger"],
        "base_radius": 0.105,
        "finger_thickness": 0.02,
    },
    "grasps": {"kind": "side", "yaws": 24, "heights": [0.35, 0.5, 0.65], "standoff": 0.10},
}

PANDA_FRAME = [
    '<link name="grasp_center"/>',
    '<joint name="grasp_center_joint" type="fixed">'
    '<parent link="panda_hand"/><child link="grasp_center"/>'
    '<origin xyz="0 0 0.1034" rpy="0 0 1.5707963267948966"/></joint>',
]
"""Between the pads, z forward; x along the hand's y, the way the fingers close."""


def official_panda(folder: Path, packages: bool = True) -> Path:
    """The official Panda with its hand and meshes; returns the robot file."""
    copy_meshes(folder, "panda_description", "collision", "visual")
    urdf = with_elements(official_urdf("panda_description", "panda.urdf"), PANDA_FRAME)
    return write_robot(folder, urdf, PANDA_KEYS, packages)
