"""A small reader of URDF text: the tree, the limits, `<mimic>` and the collision shapes.

Pinocchio does the kinematics; this reads what Pinocchio drops or would decide by itself.
"""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field

import numpy as np

from . import poses
from .violations import PlanError


@dataclass(frozen=True)
class Mimic:
    """value = multiplier · value(joint) + offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class Joint:
    """Radians for joints that turn, metres for joints that slide."""

    name: str
    kind: str
    parent: str
    child: str
    lower: float
    upper: float
    velocity: float
    mimic: Mimic | None

    @property
    def moves(self) -> bool:
        return self.kind != "fixed"


@dataclass(frozen=True)
class Collision:
    """One collision element: its pose in the link and the shape's own tag and attributes."""

    link_from_shape: np.ndarray
    shape: str
    attributes: dict[str, str]


@dataclass
class Urdf:
    """The tree, by names."""

    root: str
    joints: dict[str, Joint]
    collisions: dict[str, list[Collision]]
    parent_joint: dict[str, Joint] = field(default_factory=dict)

    def links(self) -> list[str]:
        return list(self.collisions)

    def chain(self, link: str) -> list[Joint]:
        """The joints from `link` up to the root."""
        found = []
        while link in self.parent_joint:
            found.append(self.parent_joint[link])
            link = found[-1].parent
        return found


def _numbers(text: str | None, default) -> list[float]:
    return [float(word) for word in text.split()] if text else list(default)


def _origin(element) -> np.ndarray:
    origin = element.find("origin")
    keys = {} if origin is None else origin.attrib
    rotation = poses.rotation_from_rpy(_numbers(keys.get("rpy"), (0, 0, 0)))
    return poses.pose(rotation, _numbers(keys.get("xyz"), (0, 0, 0)))


def _joint(element) -> Joint:
    limit = element.find("limit")
    limits = {} if limit is None else limit.attrib
    kind = element.get("type")
    bounded = kind in ("revolute", "prismatic")
    mimic = element.find("mimic")
    return Joint(
        name=element.get("name"),
        kind=kind,
        parent=element.find("parent").get("link"),
        child=element.find("child").get("link"),
        lower=float(limits.get("lower", 0.0)) if bounded else -np.inf,
        upper=float(limits.get("upper", 0.0)) if bounded else np.inf,
        velocity=float(limits.get("velocity", 0.0)) or np.inf,
        mimic=None
        if mimic is None
        else Mimic(
            mimic.get("joint"),
            float(mimic.get("multiplier", 1.0)),
            float(mimic.get("offset", 0.0)),
        ),
    )


def _collision(element) -> Collision:
    shape = element.find("geometry")[0]
    return Collision(_origin(element), shape.tag, dict(shape.attrib))


def parse(text: str) -> Urdf:
    """Reads URDF text; a broken tree is a `PlanError`."""
    try:
        robot = ElementTree.fromstring(text.encode())
        joints = {j.name: j for j in map(_joint, robot.findall("joint"))}
        collisions = {
            link.get("name"): [_collision(c) for c in link.findall("collision")]
            for link in robot.findall("link")
        }
    except (ElementTree.ParseError, ValueError, AttributeError, IndexError) as error:
        raise PlanError(f"robot.urdf cannot be read: {error}") from error
    parent_joint = {joint.child: joint for joint in joints.values()}
    roots = [link for link in collisions if link not in parent_joint]
    if len(roots) != 1:
        raise PlanError(f"robot.urdf has {len(roots)} root links: {roots}")
    return Urdf(roots[0], joints, collisions, parent_joint)


def kinematics_only(text: str) -> str:
    """The URDF without shapes and without `<mimic>`: every joint free, for Pinocchio."""
    robot = ElementTree.fromstring(text.encode())
    for link in robot.findall("link"):
        for tag in ("visual", "collision"):
            for element in link.findall(tag):
                link.remove(element)
    for joint in robot.findall("joint"):
        for element in joint.findall("mimic"):
            joint.remove(element)
    for tag in ("gazebo", "transmission", "material"):
        for element in robot.findall(tag):
            robot.remove(element)
    return ElementTree.tostring(robot, encoding="unicode")
