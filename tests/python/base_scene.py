"""A valid scene to spoil or vary: a UR10 before a cabinet, cylinders in it, a tray beside it.

Metres, world frame. The cabinet's floor is at z = 0.6, its opening faces −x at x = 0.65; the tray
lies on a table whose top is at z = 0.5.
"""

import json
from pathlib import Path

RADIUS, HEIGHT = 0.037, 0.26
FLOOR, TABLE = 0.6, 0.5
STANDING = FLOOR + HEIGHT / 2
"""z of the centre of a cylinder that stands in the cabinet."""


def box(name: str, size, position) -> dict:
    return {"id": name, "box": {"size": list(size)}, "position": list(position)}


def cylinder(name: str, x: float, y: float, z: float = STANDING) -> dict:
    shape = {"radius": RADIUS, "height": HEIGHT}
    return {"id": name, "cylinder": shape, "position": [x, y, z]}


def scene() -> dict:
    """The scene file's content. The target `wanted` stands in the second row."""
    return {
        "format": "clearway-scene/1",
        "name": "base",
        "frame": "world",
        "robot": {
            "model": "ur10_ag95",
            "base": {"position": [0.0, 0.0, 0.3], "rpy": [0.0, 0.0, 0.0]},
        },
        "fixtures": [
            box("floor", [0.6, 0.94, 0.02], [0.95, 0.0, 0.59]),
            box("left_wall", [0.6, 0.02, 0.5], [0.95, 0.46, 0.85]),
            box("right_wall", [0.6, 0.02, 0.5], [0.95, -0.46, 0.85]),
            box("back_wall", [0.02, 0.94, 0.5], [1.26, 0.0, 0.85]),
            box("ceiling", [0.6, 0.94, 0.02], [0.95, 0.0, 1.11]),
            box("table", [0.6, 0.9, 0.04], [0.1, -0.8, 0.48]),
        ],
        "objects": [
            cylinder("near_left", 0.78, 0.12),
            cylinder("near_middle", 0.77, 0.0),
            cylinder("near_right", 0.78, -0.12),
            cylinder("wanted", 0.92, 0.02),
            cylinder("far_left", 0.95, 0.28),
            cylinder("far_right", 0.95, -0.25),
        ],
        "target": "wanted",
        "place": [{"id": "tray", "size": [0.5, 0.8], "position": [0.1, -0.8, TABLE]}],
    }


def yaml_text(content: dict) -> str:
    """YAML with one line per body, so that the line of an error is known. Written by hand, for
    JSON values on one line are YAML."""
    lines = []
    for key, value in content.items():
        if isinstance(value, list) and value:
            lines += [f"{key}:", *(f"  - {json.dumps(item)}" for item in value)]
        elif isinstance(value, dict):
            lines += [f"{key}:", *(f"  {k}: {json.dumps(v)}" for k, v in value.items())]
        else:
            lines.append(f"{key}: {json.dumps(value)}")
    return "\n".join(lines) + "\n"


def write(folder: Path, content: dict, name: str = "scene.yaml") -> Path:
    """Writes the scene into `folder`; returns its path."""
    path = folder / name
    path.write_text(yaml_text(content), encoding="utf-8")
    return path


def line_of(text: str, part: str) -> int:
    """The number, from 1, of the first line with `part` in it."""
    return next(i for i, line in enumerate(text.splitlines(), 1) if part in line)
