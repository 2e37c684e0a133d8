"""Reads URDF text: links with their shapes and inertias, joints with what they mimic."""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field

import numpy as np

from . import poses, shapes
from .unplayable import Unplayable


@dataclass(frozen=True)
class Inertia:
    """Mass, its centre's pose in the link, and the six entries (xx yy zz xy xz yz) in that pose."""

    mass: float
    at: np.ndarray
    entries: tuple[float, ...]


@dataclass(frozen=True)
class Link:
    name: str
    parts: tuple[shapes.Shape, ...]
    inertia: Inertia | None


@dataclass(frozen=True)
class Joint:
    """`at`: the pose in the parent link. `effort` in N or N m, 0 for none given.
    `mimic`: (joint, multiplier, offset)."""

    name: str
    kind: str
    parent: str
    child: str
    at: np.ndarray
    axis: np.ndarray
    effort: float
    mimic: tuple[str, float, float] | None

    @property
    def slides(self) -> bool:
        return self.kind == "prismatic"


@dataclass
class Urdf:
    root: str
    links: dict[str, Link]
    joints: dict[str, Joint]
    below: dict[str, list[Joint]] = field(default_factory=dict)


def _numbers(text: str | None, default) -> list[float]:
    return [float(word) for word in text.split()] if text else list(default)


def _origin(element) -> np.ndarray:
    found = element.find("origin")
    keys = {} if found is None else found.attrib
    rotation = poses.from_rpy(_numbers(keys.get("rpy"), (0, 0, 0)))
    return poses.pose(rotation, _numbers(keys.get("xyz"), (0, 0, 0)))


def _inertia(element) -> Inertia | None:
    if element is None or not float(element.find("mass").get("value")) > 0:
        return None
    keys = element.find("inertia")
    entries = tuple(float(keys.get(k, 0.0)) for k in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
    return Inertia(float(element.find("mass").get("value")), _origin(element), entries)


def _link(element) -> Link:
    parts = []
    for collision in element.findall("collision"):
        shape = collision.find("geometry")[0]
        parts.append(shapes.of_urdf(shape.tag, shape.attrib, _origin(collision)))
    return Link(element.get("name"), tuple(parts), _inertia(element.find("inertial")))


def _joint(element) -> Joint:
    axis, limit, mimic = (element.find(tag) for tag in ("axis", "limit", "mimic"))
    if (kind := element.get("type")) not in ("fixed", "revolute", "continuous", "prismatic"):
        raise Unplayable(f"robot.urdf: joint {element.get('name')} is {kind}")
    follows = None
    if mimic is not None:
        multiplier, offset = mimic.get("multiplier", 1.0), mimic.get("offset", 0.0)
        follows = (mimic.get("joint"), float(multiplier), float(offset))
    return Joint(
        name=element.get("name"),
        kind=kind,
        parent=element.find("parent").get("link"),
        child=element.find("child").get("link"),
        at=_origin(element),
        axis=np.array(_numbers(None if axis is None else axis.get("xyz"), (1, 0, 0))),
        effort=0.0 if limit is None else float(limit.get("effort", 0.0)),
        mimic=follows,
    )


def parse(text: str) -> Urdf:
    """The tree; its root is the one link that no joint has as its child."""
    robot = ElementTree.fromstring(text.encode())
    links = {link.name: link for link in map(_link, robot.findall("link"))}
    joints = {joint.name: joint for joint in map(_joint, robot.findall("joint"))}
    roots = links.keys() - {joint.child for joint in joints.values()}
    if len(roots) != 1:
        raise Unplayable(f"robot.urdf has {len(roots)} root links")
    tree = Urdf(roots.pop(), links, joints)
    for joint in joints.values():
        tree.below.setdefault(joint.parent, []).append(joint)
    return tree
