"""Objects that do not stand exactly where the scene says."""

import mujoco
import numpy as np

from .carriers import carriers
from .scene_bodies import OBJECT
from .world import World

_HALVINGS, _OVERLAP = 12, 1e-4
"""How often a displacement is halved before it is given up; metres that count as overlapping."""


def in_a_disc(names: list[str], radius: float, seed: int | None) -> dict[str, np.ndarray]:
    """Horizontal displacements, uniform in a disc."""
    draw = np.random.default_rng(seed)
    found = {}
    for name in names:
        far, angle = radius * np.sqrt(draw.random()), draw.uniform(0, 2 * np.pi)
        found[name] = far * np.array([np.cos(angle), np.sin(angle)])
    return found


def displace(world: World, wanted: dict) -> dict[str, np.ndarray]:
    """Moves objects by `wanted` (name → x, y); what overlaps something anew is moved by half, by a
    quarter and so on, in the end not at all. What rests on an object goes with it instead of by its
    own. Returns by how much each was moved."""
    start = {name: world.object_pose(name) for name in world.objects}
    by = {name: np.array(wanted.get(name, (0.0, 0.0)), float) for name in world.objects}
    under = _object_below(world)
    allowed = _overlaps(world, start, dict.fromkeys(by, np.zeros(2)), under)
    for turn in range(_HALVINGS + 1):
        clashing = _overlaps(world, start, by, under) - allowed
        if not clashing:
            break
        for name in {name for pair in clashing for name in pair if name in by}:
            by[name] *= 0.0 if turn == _HALVINGS - 1 else 0.5
    _overlaps(world, start, by, under)
    return {name: by[_lowest(name, under)] for name in by}


def _object_below(world: World) -> dict[str, str]:
    """Object → the first object that it rests on."""
    found = {}
    for name in world.objects:
        for body in sorted(carriers(world, name)):
            if world.owners[body].startswith(OBJECT):
                found.setdefault(name, world.owners[body].removeprefix(OBJECT))
    return found


def _lowest(name: str, under: dict[str, str]) -> str:
    while name in under:
        name = under[name]
    return name


def _overlaps(world: World, start: dict, by: dict, under: dict) -> set[tuple[str, str]]:
    """Puts the objects there, and says which pairs overlap: objects' names, others' with prefix."""
    for name, at in start.items():
        moved = at.copy()
        moved[:2, 3] += by[_lowest(name, under)]
        world.set_object(name, moved)
    mujoco.mj_fwdPosition(world.model, world.data)
    found = set()
    for contact in world.data.contact:
        owners = [world.owners[world.owner_of_geom[geom]] for geom in contact.geom]
        names = sorted(_lowest(o.removeprefix(OBJECT), under) for o in owners)
        if contact.dist < -_OVERLAP:
            found.add(tuple(names))
    return found
