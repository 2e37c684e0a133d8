"""Exact shapes: a `Part` is one Coal geometry with its pose in the body that owns it.

Cylinders and capsules lie along their own z; a capsule's height is its cylindrical part. A
mesh of a link is its triangles as they are; a mesh of the scene is the convex hulls of its
connected parts; a point cloud is a ball per point.
"""

from dataclasses import dataclass, field

import coal
import numpy as np

from . import poses

SIGNS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)


@dataclass
class Part:
    """`geometry` is None for a point cloud, which has `points` (k×3, its own frame) instead."""

    kind: str
    geometry: object
    body_from_part: np.ndarray
    centre: np.ndarray
    half: np.ndarray
    radius: float = 0.0
    points: np.ndarray | None = None
    corners: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        self.corners = self.centre + SIGNS * self.half
        """The corners of the box round the part, in its own frame."""

    @property
    def is_mesh(self) -> bool:
        return self.kind == "mesh"

    def triangles(self, indices: list[int]) -> np.ndarray:
        """k×3×3: the corners of some of a mesh's triangles, in the part's frame."""
        found = [self.geometry.tri_indices(i) for i in indices]
        corners = np.array([[t[0], t[1], t[2]] for t in found], int).reshape(-1, 3)
        return self.points[corners]

    def bounds(self, world_from_part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The lowest and highest world coordinates, exact, of one posed part."""
        rotation, position = world_from_part[:3, :3], world_from_part[:3, 3]
        if self.points is not None:
            points = poses.apply(world_from_part, self.points)
            return points.min(0) - self.radius, points.max(0) + self.radius
        if self.kind == "box":
            reach = np.abs(rotation) @ self.half
        elif self.kind == "sphere":
            reach = np.full(3, self.radius)
        else:
            along = np.abs(rotation[:, 2])
            if self.kind == "cylinder":
                around = self.radius * np.sqrt(np.maximum(0.0, 1.0 - along**2))
                reach = self.half[2] * along + around
            else:
                reach = (self.half[2] - self.radius) * along + self.radius
        return position - reach, position + reach

    def loose_bounds(self, world_from_part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lows and highs (n×3) of the turned box round the part, for n poses."""
        rotation = world_from_part[:, :3, :3]
        centre = rotation @ self.centre + world_from_part[:, :3, 3]
        reach = np.abs(rotation) @ self.half
        return centre - reach, centre + reach


def box(size, body_from_part=np.eye(4)) -> Part:
    """Full edge lengths (metres)."""
    half = np.asarray(size, float) / 2
    return Part("box", coal.Box(*(2 * half)), body_from_part, np.zeros(3), half)


def cylinder(radius: float, height: float, body_from_part=np.eye(4)) -> Part:
    """Along z; the full height (metres)."""
    half = np.array([radius, radius, height / 2])
    geometry = coal.Cylinder(radius, height)
    return Part("cylinder", geometry, body_from_part, np.zeros(3), half, radius)


def sphere(radius: float, body_from_part=np.eye(4)) -> Part:
    half = np.full(3, float(radius))
    return Part("sphere", coal.Sphere(radius), body_from_part, np.zeros(3), half, radius)


def capsule(radius: float, height: float, body_from_part=np.eye(4)) -> Part:
    """Along z; the height of the cylindrical part, without the caps (metres)."""
    half = np.array([radius, radius, height / 2 + radius])
    geometry = coal.Capsule(radius, height)
    return Part("capsule", geometry, body_from_part, np.zeros(3), half, radius)


def _box_round(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    low, high = points.min(0), points.max(0)
    return (low + high) / 2, (high - low) / 2


def hull(points: np.ndarray, body_from_part=np.eye(4)) -> Part:
    """The convex hull of points (k×3, metres)."""
    vertices = coal.StdVec_Vec3s()
    for point in points:
        vertices.append(np.asarray(point, float))
    try:
        geometry = coal.Convex.convexHull(vertices, False, "Qt")
    except RuntimeError:  # a flat side of more corners than Coal has room for: joggle it
        geometry = coal.Convex.convexHull(vertices, False, "QJ")
    return Part("hull", geometry, body_from_part, *_box_round(points), points=points)


def triangles(model, body_from_part=np.eye(4)) -> Part:
    """A bounding-volume tree of triangles, already scaled."""
    vertices = np.array(model.vertices())
    return Part("mesh", model, body_from_part, *_box_round(vertices), points=vertices)


def cloud(points: np.ndarray, radius: float, body_from_part=np.eye(4)) -> Part:
    """A ball of `radius` round each point (k×3)."""
    centre, half = _box_round(points)
    return Part("points", None, body_from_part, centre, half + radius, radius, points)
