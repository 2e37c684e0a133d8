"""Primitive shapes of plan files as MJCF geoms."""

import math
from dataclasses import dataclass

import numpy as np

from . import poses
from .unplayable import Unplayable


@dataclass(frozen=True)
class Shape:
    """MuJoCo's type and half sizes, the volume (m³), and the pose in the body."""

    kind: str
    size: tuple[float, ...]
    volume: float
    at: np.ndarray

    def geom(self) -> dict[str, str]:
        """The attributes of an MJCF `geom`."""
        return {"type": self.kind, "size": poses.words(self.size), **poses.attributes(self.at)}


def box(size, at) -> Shape:
    return Shape("box", tuple(float(edge) / 2 for edge in size), math.prod(map(float, size)), at)


def cylinder(radius: float, height: float, at) -> Shape:
    return Shape("cylinder", (radius, height / 2), math.pi * radius**2 * height, at)


def sphere(radius: float, at) -> Shape:
    return Shape("sphere", (radius,), math.pi * radius**3 * 4 / 3, at)


def capsule(radius: float, height: float, at) -> Shape:
    """`height` is that of the cylindrical part."""
    volume = math.pi * radius**2 * (height + radius * 4 / 3)
    return Shape("capsule", (radius, height / 2), volume, at)


def of_body(keys: dict, at=None) -> list[Shape]:
    """The shapes of a fixture or an object, in its own frame."""
    at = np.eye(4) if at is None else at
    if keys.get("box"):
        return [box(keys["box"]["size"], at)]
    for name, make in (("cylinder", cylinder), ("capsule", capsule)):
        if found := keys.get(name):
            return [make(float(found["radius"]), float(found["height"]), at)]
    if found := keys.get("sphere"):
        return [sphere(float(found["radius"]), at)]
    if parts := keys.get("compound"):
        return [shape for part in parts for shape in of_body(part, at @ poses.from_keys(part))]
    raise Unplayable(f"{keys.get('id', 'a part')}: not of boxes, cylinders, spheres or capsules")


def of_urdf(tag: str, keys: dict[str, str], at) -> Shape:
    """The shape of one URDF `<geometry>`."""
    if tag == "box":
        return box([float(word) for word in keys["size"].split()], at)
    if tag == "sphere":
        return sphere(float(keys["radius"]), at)
    if tag in ("cylinder", "capsule"):
        make = cylinder if tag == "cylinder" else capsule
        return make(float(keys["radius"]), float(keys["length"]), at)
    raise Unplayable(f"robot.urdf: a collision shape of kind {tag}")
