"""An arm of spheres, and motion problems for it: all that a test of plain motion planning needs."""

import numpy as np

import motion_checker

LINK = 0.36
"""Length of an upper link, metres; its spheres stand along its z."""


def _link(name: str, spheres) -> str:
    shapes = "".join(
        f'<collision><origin xyz="{x} {y} {z}"/><geometry><sphere radius="{r}"/></geometry>'
        "</collision>"
        for x, y, z, r in spheres
    )
    return f'<link name="{name}">{shapes}</link>'


def _joint(name: str, parent: str, child: str, z: float, axis: str, turn: float) -> str:
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0 0 {z}" rpy="0 0 0.3"/><axis xyz="{axis}"/>'
        f'<limit lower="{-turn}" upper="{turn}" velocity="2" effort="1"/></joint>'
    )


def urdf() -> str:
    """Four turning joints: up, then three across; the frames are turned against each other."""
    column = [(0.0, 0.0, z, 0.06) for z in (0.0, 0.1)]
    upper = [(0.0, 0.0, z, 0.05) for z in (0.08, 0.16, 0.24, 0.32)]
    return "\n".join(
        [
            '<robot name="sphere_arm">',
            _link("base", [(0.0, 0.0, 0.0, 0.08)]),
            _link("column", column),
            _link("upper", upper),
            _link("fore", upper),
            _link("hand", [(0.0, 0.0, 0.06, 0.04), (0.02, 0.0, 0.12, 0.03)]),
            _joint("pan", "base", "column", 0.12, "0 0 1", 3.0),
            _joint("shoulder", "column", "upper", 0.12, "0 1 0", 2.2),
            _joint("elbow", "upper", "fore", LINK, "0 1 0", 2.5),
            _joint("wrist", "fore", "hand", LINK, "1 0 0", 2.0),
            "</robot>",
        ]
    )


JOINTS = ["pan", "shoulder", "elbow", "wrist"]
LIMITS = np.array([3.0, 2.2, 2.5, 2.0])


def problem(random: np.random.Generator, index: int, cuboids: bool) -> dict:
    """Six obstacles at arm's length, a start and two goals with room to spare. `cuboids`: as in the
    set `box`, where cylinders stand for the cuboid round them."""
    while True:
        shapes = {"sphere": [], "box": [], "cylinder": []}
        for number in range(6):
            angle, far = random.uniform(-np.pi, np.pi), random.uniform(0.35, 0.8)
            shape = {
                "name": f"thing{number}",
                "position": [far * np.cos(angle), far * np.sin(angle), random.uniform(0.1, 0.9)],
                "orientation_quat_xyzw": (q := random.normal(size=4), list(q / np.linalg.norm(q)))[
                    1
                ],
            }
            kind = ("sphere", "box", "cylinder")[number % 3]
            if kind == "sphere":
                shape["radius"] = random.uniform(0.05, 0.15)
            elif kind == "box":
                shape["half_extents"] = list(random.uniform(0.02, 0.2, size=3))
            else:
                shape["radius"], shape["length"] = (
                    random.uniform(0.03, 0.1),
                    random.uniform(0.1, 0.5),
                )
            shapes[kind].append(shape)
        parts = motion_checker.parts_of(shapes, "peer", cuboids)
        rows = random.uniform(-LIMITS, LIMITS, size=(400, 4))
        arm = motion_checker.SphereRobot(urdf(), JOINTS)
        free = rows[arm.clearances(rows, parts) > 0.01]
        if len(free) >= 3:
            start, *goals = free[:3].tolist()
            return {"index": index, "valid": True, "start": start, "goals": goals, **shapes}


def problems(seed: int) -> dict:
    random = np.random.default_rng(seed)
    sets = {
        name: [problem(random, i + 1, name == "box") for i in range(5)] for name in ("open", "box")
    }
    return {"robot": "sphere_arm", "joints": list(JOINTS), "problems": sets}
