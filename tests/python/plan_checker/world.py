"""The scene of a plan: fixtures, objects and where they stand, places, and what carries what."""

from dataclasses import dataclass

import numpy as np

from . import poses, shapes, tolerances
from .distance import signed_distance
from .meshes import MeshStore, connected_parts
from .violations import PlanError

_LOWERED = 3e-3
"""Metres an object is lowered by to see what would stop it."""


_FRICTION = 0.4
"""Of what says nothing of it."""


@dataclass
class Body:
    """A fixture or an object. `start` is the scene's world pose of the shape's centre."""

    id: str
    parts: list[shapes.Part]
    start: np.ndarray

    def corners(self) -> np.ndarray:
        """The corners of the boxes round its parts, in its own frame."""
        return np.concatenate([poses.apply(p.body_from_part, p.corners) for p in self.parts])

    def bounds(self, world_from_body: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Exact lowest and highest world coordinates."""
        found = [part.bounds(world_from_body @ part.body_from_part) for part in self.parts]
        return np.min([f[0] for f in found], axis=0), np.max([f[1] for f in found], axis=0)


@dataclass(frozen=True)
class Place:
    """A level rectangle: `low` and `high` in world x and y, at height `z`."""

    id: str
    low: np.ndarray
    high: np.ndarray
    z: float


def _scale(value) -> np.ndarray:
    if value is None:
        return np.ones(3)
    return np.broadcast_to(np.asarray(value, float), 3).copy()


def shape_parts(keys: dict, at: np.ndarray, meshes: MeshStore, where: str) -> list[shapes.Part]:
    """The parts of the one shape in `keys`, posed by `at` in the body."""
    if box := keys.get("box"):
        return [shapes.box(box["size"], at)]
    if cylinder := keys.get("cylinder"):
        return [shapes.cylinder(cylinder["radius"], cylinder["height"], at)]
    if sphere := keys.get("sphere"):
        return [shapes.sphere(sphere["radius"], at)]
    if capsule := keys.get("capsule"):
        return [shapes.capsule(capsule["radius"], capsule["height"], at)]
    if mesh := keys.get("mesh"):
        model = meshes.triangles(mesh["file"], _scale(mesh.get("scale")))
        return [] if model is None else [shapes.hull(p, at) for p in connected_parts(model)]
    if points := keys.get("points"):
        groups = meshes.point_groups(points["file"])
        return [shapes.cloud(group, points["radius"], at) for group in groups]
    if compound := keys.get("compound"):
        return [
            part
            for keys_of_part in compound
            for part in shape_parts(keys_of_part, at @ poses.from_keys(keys_of_part), meshes, where)
        ]
    raise PlanError(f"{where}: no shape")


def _bodies(entries: list[dict], meshes: MeshStore, where: str) -> dict[str, Body]:
    found = {}
    for entry in entries:
        name = entry["id"]
        if name in found:
            raise PlanError(f"{where}: two with the id {name}")
        parts = shape_parts(entry, np.eye(4), meshes, f"{where} {name}")
        if not parts:
            raise PlanError(f"{where} {name}: its shape could not be loaded")
        found[name] = Body(name, parts, poses.from_keys(entry))
    return found


class World:
    """What stands where. `standing` changes as the plan is replayed."""

    def __init__(self, scene: dict, meshes: MeshStore) -> None:
        self.fixtures = _bodies(scene.get("fixtures") or [], meshes, "fixture")
        self.objects = _bodies(scene["objects"], meshes, "object")
        for name in self.objects.keys() & self.fixtures.keys():
            raise PlanError(f"{name} is both a fixture and an object")
        self.target: str = scene["target"]
        if self.target not in self.objects:
            raise PlanError(f"the target {self.target} is no object")
        self.places = []
        for entry in scene.get("place") or []:
            centre, size = np.asarray(entry["position"], float), np.asarray(entry["size"], float)
            low, high = centre[:2] - size / 2, centre[:2] + size / 2
            self.places.append(Place(entry["id"], low, high, float(centre[2])))
        self.standing = {name: body.start for name, body in self.objects.items()}
        self.clearance = float(scene.get("clearance") or 0.0)
        usual = scene.get("friction") or _FRICTION
        self.friction = {o["id"]: float(o.get("friction") or usual) for o in scene["objects"]}

    def still(self, leave_out=()) -> list[tuple[Body, np.ndarray]]:
        """The fixtures, then the standing objects, with their world poses."""
        bodies = [(body, body.start) for body in self.fixtures.values()]
        bodies += [(self.objects[n], at) for n, at in self.standing.items() if n not in leave_out]
        return bodies

    def contacts(self, name: str, at: np.ndarray) -> list[tuple[str, int, float, bool]]:
        """What an object at pose `at` comes within a millimetre of: body, index of the body's
        part, signed distance, and whether that part carries it (stops it when lowered)."""
        body = self.objects[name]
        low, high = body.bounds(at)
        lowered = at.copy()
        lowered[2, 3] -= _LOWERED
        found = []
        for other, other_at in self.still(leave_out=(name,)):
            for index, part in enumerate(other.parts):
                world_from_part = other_at @ part.body_from_part
                part_low, part_high = part.bounds(world_from_part)
                reach = tolerances.RESTING + tolerances.DISTANCE_SLACK
                if np.any(part_low > high + reach) or np.any(part_high < low - reach):
                    continue
                apart = min(
                    signed_distance(p, at @ p.body_from_part, part, world_from_part)
                    for p in body.parts
                )
                if apart > reach:
                    continue
                below = min(
                    signed_distance(p, lowered @ p.body_from_part, part, world_from_part)
                    for p in body.parts
                )
                carries = -reach <= apart and apart - below >= 0.6 * _LOWERED
                found.append((other.id, index, apart, carries))
        return found

    def carriers(self, name: str, at: np.ndarray) -> set[tuple[str, int]]:
        """The parts of bodies that an object at `at` rests on."""
        return {(c[0], c[1]) for c in self.contacts(name, at) if c[3]}

    def place_under(self, name: str, at: np.ndarray) -> Place | None:
        """The place whose height the object's underside has and that its footprint lies inside."""
        low, high = self.objects[name].bounds(at)
        for place in self.places:
            level = abs(low[2] - place.z) <= tolerances.RESTING + tolerances.DISTANCE_SLACK
            inside = np.all(low[:2] >= place.low - tolerances.INSIDE) and np.all(
                high[:2] <= place.high + tolerances.INSIDE
            )
            if level and inside:
                return place
        return None
