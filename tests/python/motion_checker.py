"""Paths of a robot of spheres checked again: kinematics and distances in f64, by closed forms.

Shares nothing with the program, and only poses with the checker of plans.
"""

import xml.etree.ElementTree as ElementTree

import numpy as np

from plan_checker import poses


class Part:
    """A shape with its pose in the root frame: `box` (half sizes), `cylinder` and `capsule`
    (radius, half length along z), `sphere` (radius)."""

    def __init__(self, kind: str, size, root_from_part: np.ndarray) -> None:
        self.kind, self.size, self.pose = kind, size, root_from_part

    def distance(self, points: np.ndarray) -> np.ndarray:
        """From each of the points; negative inside, where it may be nearer to 0 than the depth."""
        p = poses.apply(poses.inverse(self.pose), points)
        if self.kind == "sphere":
            return np.linalg.norm(p, axis=-1) - self.size
        if self.kind == "box":
            off = np.abs(p) - np.asarray(self.size)
            return np.linalg.norm(np.maximum(off, 0.0), axis=-1) + np.minimum(off.max(-1), 0.0)
        radius, half = self.size
        across = np.hypot(p[..., 0], p[..., 1])
        if self.kind == "capsule":
            return np.hypot(across, np.maximum(np.abs(p[..., 2]) - half, 0.0)) - radius
        off = np.stack([across - radius, np.abs(p[..., 2]) - half], axis=-1)
        return np.linalg.norm(np.maximum(off, 0.0), axis=-1) + np.minimum(off.max(-1), 0.0)


def parts_of(problem: dict, cylinders: str, cuboids: bool) -> list[Part]:
    """The obstacles of a benchmark's problem. `cylinders`: `true`, or as the `peer` takes them,
    which in the set `box` (`cuboids`) is the cuboid round them."""
    found = []
    for shape in problem.get("sphere", []):
        found.append(Part("sphere", shape["radius"], _pose(shape)))
    for shape in problem.get("box", []):
        found.append(Part("box", shape["half_extents"], _pose(shape)))
    for shape in problem.get("cylinder", []):
        radius, half = shape["radius"], shape["length"] / 2
        if cylinders == "true":
            found.append(Part("cylinder", (radius, half), _pose(shape)))
        elif cuboids:
            found.append(Part("box", (radius, radius, half), _pose(shape)))
        else:
            found.append(Part("capsule", (radius, half), _pose(shape)))
    return found


def _pose(shape: dict) -> np.ndarray:
    return poses.pose(
        poses.rotation_from_quaternion(shape["orientation_quat_xyzw"]), shape["position"]
    )


class _Joint:
    def __init__(self, element) -> None:
        self.name, self.kind = element.get("name"), element.get("type")
        self.parent, self.child = (
            element.find("parent").get("link"),
            element.find("child").get("link"),
        )
        self.origin = _origin(element)
        axis = element.find("axis")
        self.axis = _numbers(axis.get("xyz") if axis is not None else "1 0 0")
        if self.kind != "fixed":
            self.axis = self.axis / np.linalg.norm(self.axis)


def _numbers(text: str) -> np.ndarray:
    return np.array([float(word) for word in text.split()])


def _origin(element) -> np.ndarray:
    origin = element.find("origin")
    keys = origin.attrib if origin is not None else {}
    rotation = poses.rotation_from_rpy(_numbers(keys.get("rpy", "0 0 0")))
    return poses.pose(rotation, _numbers(keys.get("xyz", "0 0 0")))


class SphereRobot:
    """A URDF whose collision shapes are spheres; `joints` are the columns of the rows."""

    def __init__(self, text: str, joints: list[str]) -> None:
        robot, self.joints = ElementTree.fromstring(text), joints
        self.spheres = {
            link.get("name"): [
                (_origin(c)[:3, 3], float(c.find("geometry/sphere").get("radius")))
                for c in link.findall("collision")
            ]
            for link in robot.findall("link")
        }
        self.tree = [_Joint(joint) for joint in robot.findall("joint")]
        (self.root,) = set(self.spheres) - {joint.child for joint in self.tree}

    def link_poses(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        """root_from_link by link, a 4×4 matrix per row."""
        placed = {self.root: np.broadcast_to(np.eye(4), (len(rows), 4, 4))}
        waiting = list(self.tree)
        while waiting:
            joint = waiting.pop(0)
            if joint.parent not in placed:
                waiting.append(joint)
                continue
            values = rows[:, self.joints.index(joint.name)] if joint.name in self.joints else None
            placed[joint.child] = (
                placed[joint.parent] @ joint.origin @ _moved(joint, values, len(rows))
            )
        return placed

    def centres(self, rows: np.ndarray, held=()) -> list[tuple[str, np.ndarray, float]]:
        """Link, middle by row, radius; of `held` (link, point, radius, name) as well."""
        placed = self.link_poses(rows)
        own = [(link, link, p, r) for link, balls in self.spheres.items() for p, r in balls]
        own += [(name, link, np.asarray(p), r) for link, p, r, name in held]
        return [
            (name, placed[link][:, :3, :3] @ p + placed[link][:, :3, 3], r)
            for name, link, p, r in own
        ]

    def clearances(self, rows, parts: list[Part], held=(), ignored=()) -> np.ndarray:
        """By row: the least distance of the robot to the parts, and to itself (neighbours and the
        pairs of `ignored` aside). The root link stands still and may touch the parts."""
        rows = np.asarray(rows, float)
        balls = self.centres(rows, held)
        near = {frozenset((j.parent, j.child)) for j in self.tree}
        near |= {frozenset(pair) for pair in ignored}
        least = np.full(len(rows), np.inf)
        for number, (link, middle, radius) in enumerate(balls):
            if link != self.root:
                for part in parts:
                    least = np.minimum(least, part.distance(middle) - radius)
            for other, place, size in balls[:number]:
                if link != other and frozenset((link, other)) not in near:
                    apart = np.linalg.norm(middle - place, axis=-1) - radius - size
                    least = np.minimum(least, apart)
        return least


def _moved(joint, values, count: int) -> np.ndarray:
    found = np.broadcast_to(np.eye(4), (count, 4, 4)).copy()
    if values is None:
        return found
    x, y, z = joint.axis
    if joint.kind == "prismatic":
        found[:, :3, 3] = values[:, None] * joint.axis
        return found
    # Rodrigues' formula.
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    sin, cos = np.sin(values)[:, None, None], np.cos(values)[:, None, None]
    found[:, :3, :3] = np.eye(3) + sin * cross + (1 - cos) * (cross @ cross)
    return found


def densely(path, per_radian: float) -> np.ndarray:
    """The path's straight lines, sampled at least so often per radian of joint distance."""
    path = np.asarray(path, float)
    rows = [path[:1]]
    for a, b in zip(path, path[1:]):
        count = max(1, int(np.ceil(np.linalg.norm(b - a) * per_radian)))
        rows.append(a + (b - a) * np.arange(1, count + 1)[:, None] / count)
    return np.concatenate(rows)


def length(path) -> float:
    return float(np.linalg.norm(np.diff(np.asarray(path, float), axis=0), axis=1).sum())
