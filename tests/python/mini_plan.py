"""A plan made by hand, small enough to see through: a gantry moves two cylinders on a table.

The gantry slides along world x, y and z; its hand hangs from it and grips from above. Metres and
seconds; the URDF's root link is at the world's origin; heights are of the hand's link `hand`.
"""

import json

import numpy as np

URDF = """<?xml version="1.0"?>
<robot name="gantry">
  <link name="stand">
    <collision>
      <origin xyz="-0.4 0.2 0.05"/><geometry><box size="0.1 0.1 0.12"/></geometry>
    </collision>
  </link>
  <link name="bridge">
    <collision><geometry><box size="0.1 0.1 0.04"/></geometry></collision>
  </link>
  <link name="lamp">
    <collision>
      <origin xyz="0 0 -0.1"/><geometry><sphere radius="0.02"/></geometry>
    </collision>
  </link>
  <link name="carriage"/>
  <link name="hand">
    <collision>
      <origin xyz="0 0 -0.02"/><geometry><box size="0.14 0.05 0.04"/></geometry>
    </collision>
  </link>
  <link name="left_finger">
    <collision>
      <origin xyz="0.005 0 -0.09"/><geometry><box size="0.01 0.03 0.10"/></geometry>
    </collision>
  </link>
  <link name="right_finger">
    <collision>
      <origin xyz="-0.005 0 -0.09"/><geometry><box size="0.01 0.03 0.10"/></geometry>
    </collision>
  </link>
  <link name="grasp_center"/>
  <joint name="x" type="prismatic">
    <parent link="stand"/><child link="bridge"/><origin xyz="0 0 1"/><axis xyz="1 0 0"/>
    <limit lower="-0.5" upper="0.8" velocity="1.0" effort="1"/>
  </joint>
  <joint name="lamp_joint" type="revolute">
    <parent link="bridge"/><child link="lamp"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="3.2" velocity="1.0" effort="1"/>
  </joint>
  <joint name="y" type="prismatic">
    <parent link="bridge"/><child link="carriage"/><axis xyz="0 1 0"/>
    <limit lower="-0.5" upper="0.8" velocity="1.0" effort="1"/>
  </joint>
  <joint name="z" type="prismatic">
    <parent link="carriage"/><child link="hand"/><axis xyz="0 0 1"/>
    <limit lower="-0.95" upper="-0.1" velocity="1.0" effort="1"/>
  </joint>
  <joint name="finger_joint" type="prismatic">
    <parent link="hand"/><child link="left_finger"/><origin xyz="0.05 0 0"/><axis xyz="-1 0 0"/>
    <limit lower="0" upper="0.05" velocity="0.2" effort="1"/>
  </joint>
  <joint name="right_joint" type="prismatic">
    <parent link="hand"/><child link="right_finger"/><origin xyz="-0.05 0 0"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.05" velocity="0.2" effort="1"/>
    <mimic joint="finger_joint"/>
  </joint>
  <joint name="grasp_joint" type="fixed">
    <parent link="hand"/><child link="grasp_center"/>
    <origin xyz="0 0 -0.11" rpy="3.141592653589793 0 0"/>
  </joint>
</robot>
"""

HOME = [-0.2, 0.0, -0.6]
OPEN, CLOSED = 0.0, 0.02
"""Values of `finger_joint`; closed, the pads lie on a cylinder of radius 0.03."""
ABOVE, DOWN = -0.6, -0.81
"""Values of z: the fingers' tips at 0.26 and 0.05 above the table."""
SPEED, ACCELERATION = 0.9, 3.5
"""What the motions keep to; the limits are 1.0 and 4.0."""
IN_TOOL = {"position": [0.0, 0.0, 0.02], "quaternion": [1.0, 0.0, 0.0, 0.0]}
"""A cylinder's centre is 2 cm below `grasp_center`, whose z points down."""


def scene() -> dict:
    """Two cylinders on a table; b is wanted."""
    shape = {"radius": 0.03, "height": 0.12}
    return {
        "format": "clearway-scene/1",
        "name": "mini",
        "frame": "world",
        "robot": {"model": "gantry", "base": {"position": [0, 0, 0], "rpy": [0, 0, 0]}},
        "fixtures": [
            {"id": "table", "box": {"size": [1.2, 1.2, 0.04]}, "position": [0.1, 0.2, -0.02]}
        ],
        "objects": [
            {"id": "a", "cylinder": shape, "position": [0.0, 0.0, 0.06]},
            {"id": "b", "cylinder": shape, "position": [0.2, 0.0, 0.06]},
        ],
        "target": "b",
        "place": [{"id": "tray", "size": [0.5, 0.3], "position": [0.1, 0.4, 0.0]}],
    }


def motion(start, end) -> tuple[list[float], list[list[float]]]:
    """Times and rows of a straight line from rest to rest, 0.02 s apart."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    far = float(np.abs(end - start).max())
    lasts = max(np.pi / 2 * far / SPEED, np.pi * np.sqrt(far / 2 / ACCELERATION))
    count = max(1, int(np.ceil(lasts / 0.02)))
    share = (1 - np.cos(np.pi * np.arange(count + 1) / count)) / 2
    rows = start + share[:, None] * (end - start)
    return [round(0.02 * i, 6) for i in range(count + 1)], rows.tolist()


def segment(kind: str, start, end, gripper, attached=None) -> dict:
    times, rows = motion(start, end)
    return {
        "kind": kind,
        "times": times,
        "positions": rows,
        "gripper": {"finger_joint": gripper},
        "attached": attached,
    }


def hand_moves(kind: str, at, start: float, end: float) -> dict:
    """The fingers move while the gantry stands."""
    values = np.linspace(start, end, 11).tolist()
    times = [round(0.02 * i, 6) for i in range(11)]
    return {
        "kind": kind,
        "times": times,
        "positions": [list(at)] * 11,
        "gripper": {"finger_joint": values},
        "attached": None,
    }


def step(name: str, begin, source, goal) -> tuple[dict, list[float]]:
    """Takes the cylinder at `source` (x, y) to `goal`; returns the step and the last row."""
    over, at = [*source, ABOVE], [*source, DOWN]
    over_goal, at_goal = [*goal, ABOVE], [*goal, DOWN]
    held = {"object": name, "tool": "grasp_center", "pose_in_tool": IN_TOOL}
    segments = [
        segment("transit", begin, over, OPEN),
        segment("approach", over, at, OPEN),
        hand_moves("grasp", at, OPEN, CLOSED),
        segment("transfer", at, over, CLOSED, held),
        segment("transfer", over, over_goal, CLOSED, held),
        segment("transfer", over_goal, at_goal, CLOSED, held),
        hand_moves("release", at_goal, CLOSED, OPEN),
        segment("retreat", at_goal, over_goal, OPEN),
    ]
    placed = {"position": [*goal, 0.06], "quaternion": [0.0, 0.0, 0.0, 1.0]}
    found = {"object": name, "action": "pick_place", "segments": segments, "placed": placed}
    return found, over_goal


def plan() -> dict:
    """A plan without a fault: a, then b, both to the tray."""
    first, row = step("a", HOME, [0.0, 0.0], [-0.05, 0.4])
    second, _ = step("b", row, [0.2, 0.0], [0.2, 0.4])
    names = ["x", "y", "z"]
    result = {
        "format": "clearway-plan/1",
        "status": "solved",
        "seed": 1,
        "scene": scene(),
        "robot": {
            "urdf": URDF,
            "joints": names,
            "tool": "grasp_center",
            "fixed": {"lamp_joint": 0.3},
            "home": dict(zip(names, HOME)),
            "limits": {
                "velocity": dict.fromkeys(names, 1.0),
                "acceleration": dict.fromkeys(names, 4.0),
            },
            "hand": {
                "kind": "parallel",
                "frame": "grasp_center",
                "joint": "finger_joint",
                "opening": {"0.0": 0.1, "0.05": 0.0},
                "links": ["left_finger", "right_finger", "hand"],
                "base_radius": 0.07,
                "finger_thickness": 0.01,
            },
            "unchecked_pairs": [["hand", "left_finger"], ["left_finger", "right_finger"]],
            "meshes": [],
        },
        "removed": ["a", "b"],
        "lower_bound": {"removed": 1, "kind": "grasps", "proof": {}},
        "steps": [first, second],
    }
    return json.loads(json.dumps(result))
