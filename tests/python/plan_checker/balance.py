"""Does what stands balance? Rigid bodies of one density push each other straight up and down.

Friction may keep things from sliding; it is not asked to keep them from falling. Then things stand
if there are forces in the patches where flat undersides lie on flat tops that balance every
body: a linear programme. A body whose carriers do not meet it flat at its lowest is taken to stand.
"""

from itertools import product

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_matrix

from . import poses, shapes, tolerances

CORNERS = 32
"""Of the polygon that stands for a circle."""
_LEVEL = 1e-6
"""Metres within which points of one face lie; radians that an upright axis may lean."""


def clipped(polygon: np.ndarray, normal, offset: float) -> np.ndarray:
    """What of a convex polygon (k×2, in order) has `normal · p ≤ offset`."""
    depths = polygon @ np.asarray(normal, float) - offset
    found = []
    for i, depth in enumerate(depths):
        after = (i + 1) % len(polygon)
        if depth <= 0.0:
            found.append(polygon[i])
        if (depth < 0.0 < depths[after]) or (depths[after] < 0.0 < depth):
            share = depth / (depth - depths[after])
            found.append(polygon[i] + share * (polygon[after] - polygon[i]))
    return np.array(found).reshape(-1, 2)


def sides(polygon: np.ndarray) -> list[tuple[np.ndarray, float]]:
    """The outward normal and the offset of every side of a convex polygon."""
    centre, found = polygon.mean(0), []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        normal = np.array([b[1] - a[1], a[0] - b[0]])
        if (length := np.linalg.norm(normal)) > 1e-12:
            normal *= np.sign(normal @ (a - centre)) / length
            found.append((normal, float(normal @ a)))
    return found


def common(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Where two convex polygons overlap; one of them may be a point or a line."""
    if len(second) < 3:
        first, second = second, first
    if len(second) < 3:
        return np.zeros((0, 2))
    for normal, offset in sides(second):
        first = clipped(first, normal, offset + _LEVEL)
        if not len(first):
            break
    return first


def shrunk(polygon: np.ndarray, by: float) -> np.ndarray:
    """The convex polygon without a rim of this width."""
    if len(polygon) < 3:
        return polygon[:0]
    for normal, offset in sides(polygon):
        polygon = clipped(polygon, normal, offset - by)
        if not len(polygon):
            break
    return polygon


def _ordered(points: np.ndarray) -> np.ndarray:
    """The hull of points in the plane, in order."""
    points = points[np.lexsort(points.T)]
    rows: list[list[np.ndarray]] = []
    for line in (points, points[::-1]):
        row: list[np.ndarray] = []
        for p in line:
            while len(row) > 1 and _turn(row[-2], row[-1], p) <= 1e-15:
                row.pop()
            row.append(p)
        rows.append(row[:-1])
    return np.array([*rows[0], *rows[1]] or points[:1])


def _turn(a, b, c) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _extremes(part: shapes.Part) -> np.ndarray:
    """Points of a shape, in its frame, among which its lowest and its highest are, whatever the
    posture for boxes and hulls; for round shapes that are upright."""
    if part.points is not None:
        return part.points
    if part.kind == "box":
        return part.corners
    if part.kind == "cylinder":
        turns = 2 * np.pi * np.arange(CORNERS) / CORNERS
        ring = part.radius * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        return np.concatenate(
            [np.column_stack([ring, np.full(CORNERS, z)]) for z in (-part.half[2], part.half[2])]
        )
    return np.array([[0.0, 0.0, -part.half[2]], [0.0, 0.0, part.half[2]]])


def faces(part: shapes.Part, world_from_part: np.ndarray):
    """The lowest and the highest face: each a polygon and its height; None if it is not known."""
    leans = np.linalg.norm(world_from_part[:2, 2]) > tolerances.UPRIGHT
    if part.kind == "points" or (part.kind in ("cylinder", "capsule") and leans):
        return None
    if part.kind == "sphere":
        world_from_part = poses.pose(np.eye(3), world_from_part[:3, 3])
    points = poses.apply(world_from_part, _extremes(part))
    found = []
    for height in (points[:, 2].min(), points[:, 2].max()):
        near = np.abs(points[:, 2] - height) <= _LEVEL + part.radius * 2 * tolerances.UPRIGHT
        found.append((_ordered(points[near][:, :2]), float(height)))
    return found


def _mass(parts: list[shapes.Part], at: np.ndarray) -> tuple[float, np.ndarray]:
    """Volume and the centre of mass in world x and y."""
    volumes, centres = [], []
    for part in parts:
        volumes.append(part.geometry.computeVolume())
        centre = np.asarray(part.geometry.computeCOM()).reshape(1, 3)
        centres.append(poses.apply(at @ part.body_from_part, centre)[0, :2])
    weights = np.asarray(volumes) / sum(volumes)
    return float(sum(volumes)), weights @ np.array(centres)


class Balance:
    """Bodies, what pushes them up from below, and whether all of that can balance."""

    def __init__(self) -> None:
        self._masses: dict[str, tuple[float, np.ndarray]] = {}
        self._pushes: list[tuple[str, str | None, np.ndarray]] = []

    def add(self, name: str, mass: float, centre) -> None:
        self._masses[name] = (mass, np.asarray(centre, float))

    def push(self, upper: str, lower: str | None, patch: np.ndarray) -> None:
        """`lower` (None: what cannot fall) may push `upper` up anywhere in the patch."""
        if len(patch):
            self._pushes.append((upper, lower, patch))

    def stands(self, slack: float, names: set[str] | None = None) -> bool:
        """With patches this much wider on each side (narrower, if negative)."""
        masses = {n: m for n, m in self._masses.items() if names is None or n in names}
        if not masses:
            return True
        rows = {name: 3 * i for i, name in enumerate(masses)}
        entries, columns = [], 0
        for upper, lower, patch in self._pushes:
            if upper not in masses and lower not in masses:
                continue
            if slack < 0.0:
                patch = shrunk(patch, -slack)
            else:
                corners = np.array(list(product((-slack, slack), repeat=2)))
                patch = (patch[:, None] + corners).reshape(-1, 2)
            for point in patch:
                for name, sign in ((upper, 1.0), (lower, -1.0)):
                    if name in masses:
                        arm = point - masses[name][1]
                        for i, value in enumerate((1.0, *(arm * 10.0))):
                            entries.append((rows[name] + i, columns, sign * value))
                columns += 1
        if not entries:
            return False
        largest = max(mass for mass, _ in masses.values())
        wanted = np.zeros(3 * len(masses))
        wanted[::3] = [mass / largest for mass, _ in masses.values()]
        at = np.array([e[:2] for e in entries], int).T
        matrix = csr_matrix(([e[2] for e in entries], at), shape=(len(wanted), columns))
        answer = linprog(np.zeros(columns), A_eq=matrix, b_eq=wanted, method="highs")
        if answer.status not in (0, 2):
            raise ArithmeticError(f"the balance of forces: {answer.message}")
        return answer.status == 0

    def falling(self, slack: float) -> list[set[str]]:
        """Those that do not stand, by what hangs together."""
        if self.stands(slack):
            return []
        return [group for group in self._groups() if not self.stands(slack, group)]

    def _groups(self) -> list[set[str]]:
        groups = [{name} for name in self._masses]
        for upper, lower, _ in self._pushes:
            if upper in self._masses and lower in self._masses:
                joined = [g for g in groups if upper in g or lower in g]
                groups = [g for g in groups if g not in joined] + [set().union(*joined)]
        return groups


def balance_of(world) -> Balance:
    """Of all that stands in a `World` now."""
    ends = {
        body.id: [faces(part, at @ part.body_from_part) for part in body.parts]
        for body, at in world.still()
    }
    found = Balance()
    for name, at in world.standing.items():
        patches, met = [], set()
        for under in (other for other in ends if other != name):
            for index, patch in _meets(ends[name], ends[under]):
                patches.append((under if under in world.standing else None, patch))
                met.add((under, index))
        if not patches and (place := world.place_under(name, at)):
            corners = _ordered(np.array(list(product(*zip(place.low, place.high, strict=True)))))
            patches += [(None, common(face, corners)) for face in _lowest(ends[name])]
        for lower, patch in patches:
            found.push(name, lower, patch)
        # What carries it otherwise (a slope, a mesh from the side) is not weighed; that nothing
        # does is told elsewhere.
        if None not in ends[name] and patches and world.carriers(name, at) <= met:
            found.add(name, *_mass(world.objects[name].parts, at))
    return found


def _meets(upper: list, lower: list):
    """Yields where undersides lie on tops, with the number of the part whose top it is."""
    reach = tolerances.RESTING + tolerances.DISTANCE_SLACK
    for above in upper:
        for index, below in enumerate(lower):
            if above and below and abs(above[0][1] - below[1][1]) <= reach:
                face, top = above[0][0], below[1][0]
                if np.all(face.min(0) <= top.max(0)) and np.all(top.min(0) <= face.max(0)):
                    patch = common(face, top)
                    if len(patch):
                        yield index, patch


def _lowest(ends: list) -> list[np.ndarray]:
    """The undersides that a level place may carry."""
    bottoms = [end[0] for end in ends if end]
    height = min((z for _, z in bottoms), default=0.0)
    return [face for face, z in bottoms if z - height <= tolerances.RESTING]
