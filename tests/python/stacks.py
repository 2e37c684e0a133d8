"""Random stacks of boxes and cylinders on a slab, and what they should do.

`verdict` is by the checker's own balance of forces (`plan_checker.balance`): a stack stands, or
falls, by a clear margin, or is left out.
"""

import math
import random

import numpy as np

from plan_checker import balance, poses
from plan_checker.meshes import MeshStore
from plan_checker.violations import Report
from plan_checker.world import World

MARGIN = 3e-3
"""Metres by which all patches may shrink, or grow, without a change."""
SLAB = {"id": "slab", "box": {"size": [0.6, 0.6, 0.02]}, "position": [-0.9, 1.2, 0.19]}
"""Far from where the arm works."""
TOP = 0.2
LOW = 0.018
"""Heights are small: friction, which the balance does not ask, holds the less."""


def _block(draw: random.Random, name: str, size, x: float, y: float, bottom: float) -> dict:
    """A box of this size, turned somehow."""
    turn = draw.choice((0.0, draw.uniform(-math.pi, math.pi)))
    keys = {"id": name, "box": {"size": [round(s, 4) for s in size]}}
    height = keys["box"]["size"][2]
    keys["position"] = [round(float(x), 4), round(float(y), 4), round(bottom + height / 2, 5)]
    keys["rpy"] = [0.0, 0.0, round(turn, 4)]
    return keys


def _top(keys: dict) -> float:
    shape = keys.get("cylinder") or {"height": keys["box"]["size"][2]}
    return keys["position"][2] + shape["height"] / 2


def tower(draw: random.Random, count: int) -> list[dict]:
    """One on the other, each somewhat aside."""
    found, at, bottom = [], np.array(SLAB["position"][:2]), TOP
    for i in range(count):
        size = [draw.uniform(0.05, 0.12), draw.uniform(0.05, 0.12), draw.uniform(LOW, 0.03)]
        keys = _block(draw, f"s{i}", size, *at, bottom)
        if draw.random() < 0.25:
            del keys["box"], keys["rpy"]
            shape = {"radius": round(size[0] / 2, 4), "height": round(size[2], 4)}
            keys["cylinder"], keys["position"][2] = shape, round(bottom + shape["height"] / 2, 5)
        found.append(keys)
        bottom = _top(keys)
        at = at + [draw.uniform(-0.04, 0.04), draw.uniform(-0.04, 0.04)]
    return found


def scale(draw: random.Random, _: int) -> list[dict]:
    """A beam across a narrow block, with a load on one end or on both: what is light holds what
    is heavy, or does not."""
    x, y = SLAB["position"][:2]
    foot = _block(draw, "s0", [0.05, 0.05, 0.03], x, y, TOP)
    beam = _block(draw, "s1", [0.24, 0.05, 0.02], x + draw.uniform(-0.03, 0.03), y, _top(foot))
    beam["rpy"] = foot["rpy"] = [0.0, 0.0, 0.0]
    found = [foot, beam]
    for i, side in enumerate(draw.sample((-1.0, 1.0), draw.choice((1, 2))), 2):
        size = [draw.uniform(0.03, 0.06), 0.05, draw.uniform(LOW, 0.04)]
        at = beam["position"][0] + side * draw.uniform(0.04, 0.09)
        found.append(_block(draw, f"s{i}", size, at, y, _top(beam)))
    return found


def bridge(draw: random.Random, _: int) -> list[dict]:
    """A beam on two blocks, one of which may stop short of it; perhaps a load on an end."""
    x, y = SLAB["position"][:2]
    apart = draw.uniform(0.06, 0.10)
    feet = [
        _block(draw, f"s{i}", [0.04, 0.06, 0.03], x + side * apart, y, TOP)
        for i, side in enumerate((-1.0, 1.0))
    ]
    shift = draw.uniform(-0.08, 0.08)
    beam = _block(draw, "s2", [0.2, 0.05, 0.02], x + shift, y, _top(feet[0]))
    load = _block(draw, "s3", [0.05, 0.05, 0.04], 0.0, 0.0, _top(beam))
    load["position"][:2] = [round(x + shift + draw.uniform(-0.1, 0.1), 4), y]
    for keys in (*feet, beam):
        keys["rpy"] = [0.0, 0.0, 0.0]
    return [*feet, beam, load][: draw.choice((3, 4))]


def verdict(objects: list[dict]) -> bool | None:
    """Whether they stand on the slab; None if that is close."""
    scene = {"fixtures": [SLAB], "objects": objects, "target": objects[0]["id"], "place": []}
    world = World(scene, MeshStore([], ".", Report()))
    forces = balance.balance_of(world)
    if forces.stands(-MARGIN):
        return True
    return None if forces.stands(MARGIN) else False


def clear_stacks(seed: int, count: int) -> list[tuple[list[dict], bool]]:
    """So many stacks of every kind that stand, and as many that fall."""
    draw, found = random.Random(seed), []
    for make in (tower, scale, bridge):
        left = {True: count, False: count}
        while any(left.values()):
            objects = make(draw, draw.choice((2, 3, 4)))
            stands = verdict(objects)
            if left.get(stands) and not _overlapping(objects):
                left[stands] -= 1
                found.append((objects, stands))
    return found


def _overlapping(objects: list[dict]) -> bool:
    """Whether two that lie at one height come nearer than 5 mm by the circles round them."""
    for i, a in enumerate(objects):
        for b in objects[:i]:
            aside = math.dist(a["position"][:2], b["position"][:2])
            level = min(_top(a), _top(b)) - max(_bottom(a), _bottom(b)) > 1e-6
            if level and aside < _reach(a) + _reach(b) + 5e-3:
                return True
    return False


def _bottom(keys: dict) -> float:
    return 2 * keys["position"][2] - _top(keys)


def _reach(keys: dict) -> float:
    if box := keys.get("box"):
        return math.hypot(*box["size"][:2]) / 2
    return keys["cylinder"]["radius"]


def at_poses(scene: dict, standing: dict[str, np.ndarray]) -> dict:
    """The scene with objects at other poses (4×4, world from object)."""
    objects = []
    for keys in scene["objects"]:
        at = standing.get(keys["id"], poses.from_keys(keys))
        turn = math.atan2(at[1, 0], at[0, 0])
        kept = {k: v for k, v in keys.items() if k not in ("rpy", "quaternion")}
        objects.append({**kept, "position": at[:3, 3].tolist(), "rpy": [0.0, 0.0, turn]})
    return {**scene, "objects": objects}
