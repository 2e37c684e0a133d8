"""What carries what, at the start and where the plan puts things: those may touch."""

import mujoco
import numpy as np

from . import poses
from .scene_bodies import OBJECT
from .world import World

_LOWERED = 1.5e-3
"""Metres an object is lowered by to see what stops it."""
_LEVEL = 0.7
"""Least vertical part of the normal of a contact that carries."""


def carriers(world: World, name: str) -> set[int]:
    """The bodies under an object where it is now; leaves it there."""
    at = world.object_pose(name)
    lowered = at.copy()
    lowered[2, 3] -= _LOWERED
    world.set_object(name, lowered)
    mujoco.mj_fwdPosition(world.model, world.data)
    body, found = world.body_of[OBJECT + name], set()
    for contact in world.data.contact:
        owners = [int(world.owner_of_geom[geom]) for geom in contact.geom]
        below = contact.pos[2] < lowered[2, 3]
        if body in owners and below and abs(contact.frame[2]) > _LEVEL:
            other = owners[0] if owners[1] == body else owners[1]
            if not world.is_link(other):
                found.add(other)
    world.set_object(name, at)
    mujoco.mj_fwdPosition(world.model, world.data)
    return found


def may_touch(world: World, plan: dict) -> np.ndarray:
    """Owner × owner: true for every object and what carries it at some time of the plan. The
    objects stand as the scene has them, before and after."""
    allowed = np.zeros((world.model.nbody, world.model.nbody), bool)

    def allow(name: str) -> None:
        body = world.body_of[OBJECT + name]
        for other in carriers(world, name):
            allowed[body, other] = allowed[other, body] = True

    start = {name: world.object_pose(name) for name in world.objects}
    for name in world.objects:
        allow(name)
    for step in plan["steps"]:
        world.set_object(step["object"], poses.from_keys(step["placed"]))
        mujoco.mj_fwdPosition(world.model, world.data)
        allow(step["object"])
    for name, at in start.items():
        world.set_object(name, at)
    mujoco.mj_fwdPosition(world.model, world.data)
    return allowed
