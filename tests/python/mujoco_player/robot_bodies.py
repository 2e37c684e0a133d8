"""The robot as MJCF: a body for each link, weightless to its motors (they carry it)."""

import xml.etree.ElementTree as ElementTree

import numpy as np

from . import poses, settings
from .drives import Drives
from .urdf import Joint, Link, Urdf

LINK = "link/"
"""Before the names of links' bodies."""


class RobotBodies:
    """Adds the links to an MJCF `worldbody`. Links meet objects and fixtures, never each other;
    those that stand still with the root meet objects only: they are mounted on fixtures."""

    def __init__(self, tree: Urdf, drives: Drives, hand_links: set[str], finger: float) -> None:
        """`finger`: the inertia that a joint of the hand gets from its drive."""
        self._tree, self._drives, self._hand, self._finger = tree, drives, hand_links, finger

    def add(self, worldbody: ElementTree.Element, world_from_root: np.ndarray) -> None:
        self._add(worldbody, self._tree.root, world_from_root, None, True)

    def _add(self, parent, name: str, at, joint: Joint | None, mounted: bool) -> None:
        link = self._tree.links[name]
        body = ElementTree.SubElement(
            parent, "body", name=LINK + name, gravcomp="1", **poses.attributes(at)
        )
        if joint is not None:
            self._add_joint(body, joint)
        self._add_matter(body, link, mounted)
        for below in self._tree.below.get(name, []):
            value = self._drives.held.get(below.name, 0.0)
            moves = below.kind != "fixed" and below.name not in self._drives.held
            child_at = below.at if moves else below.at @ _moved(below, value)
            still = mounted and not moves
            self._add(body, below.child, child_at, below if moves else None, still)

    def _add_joint(self, body, joint: Joint) -> None:
        motor = settings.MOTOR_SLIDES if joint.slides else settings.MOTOR_TURNS
        if joint.name in self._drives.of_hand():
            motor = self._finger
        kind = "slide" if joint.slides else "hinge"
        axis = poses.words(joint.axis)
        ElementTree.SubElement(
            body, "joint", name=joint.name, type=kind, axis=axis, armature=f"{motor:.9g}"
        )

    def _add_matter(self, body, link: Link, mounted: bool) -> None:
        if link.inertia is not None:
            keys = {
                "pos": poses.words(link.inertia.at[:3, 3]),
                "mass": f"{link.inertia.mass:.9g}",
                "fullinertia": poses.words(_turned(link.inertia)),
            }
            ElementTree.SubElement(body, "inertial", **keys)
        grips = link.name in self._hand
        for part in link.parts:
            ElementTree.SubElement(
                body,
                "geom",
                **part.geom(),
                density="1000",
                contype="4",
                conaffinity="1" if mounted else "3",
                condim="4" if grips else "3",
                friction=f"{settings.PADS if grips else 0.0} {settings.SPIN if grips else 0.0} 0",
                **(settings.PAD_CONTACT if grips else settings.CONTACT),
            )


def _moved(joint: Joint, value: float) -> np.ndarray:
    if joint.kind == "fixed":
        return np.eye(4)
    if joint.slides:
        return poses.pose(np.eye(3), joint.axis / np.linalg.norm(joint.axis) * value)
    return poses.pose(poses.turn(joint.axis, value), (0, 0, 0))


def _turned(inertia) -> tuple[float, ...]:
    """The six entries along the link's axes."""
    xx, yy, zz, xy, xz, yz = inertia.entries
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    rotation = inertia.at[:3, :3]
    m = rotation @ matrix @ rotation.T
    return m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2]
