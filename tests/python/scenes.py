"""Generated scenes and plans as the tests read them: which object is on which, by circles alone."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from check_plan import check_file
from clearway_cli import SOLVED, Clearway
from plan_checker import poses

LEVEL = 1e-3
"""Metres between an underside and the top that it rests on, at most."""


@dataclass(frozen=True)
class Standing:
    """An upright cylinder, or the one round an upright box, metres."""

    x: float
    y: float
    radius: float
    bottom: float
    top: float

    def rests_on(self, other: "Standing") -> bool:
        """On its top, with more than an edge."""
        apart = np.hypot(self.x - other.x, self.y - other.y)
        level = abs(self.bottom - other.top) <= LEVEL
        return level and apart < self.radius + other.radius - LEVEL


def generated(clearway: Clearway, folder: Path, kind: str, objects: int, seed: int) -> Path:
    path = folder / f"{kind}-{objects}-{seed}.yaml"
    done = clearway.run("generate", kind, "--objects", objects, "--seed", seed, "-o", path)
    assert done.code == SOLVED, done.err
    return path


def read(path: Path) -> dict:
    """A scene file."""
    return yaml.safe_load(path.read_text())


def standing(scene: dict, places: dict[str, np.ndarray] | None = None) -> dict[str, Standing]:
    """Where the scene has its objects, or `places` has them (4×4, world from object)."""
    found = {}
    for keys in scene["objects"]:
        at = (places or {}).get(keys["id"], poses.from_keys(keys))
        assert np.linalg.norm(at[:2, 2]) < 1e-3, f"{keys['id']} leans"
        x, y, z = at[:3, 3]
        if box := keys.get("box"):
            radius, half = np.hypot(*box["size"][:2]) / 2, box["size"][2] / 2
        else:
            radius, half = keys["cylinder"]["radius"], keys["cylinder"]["height"] / 2
        found[keys["id"]] = Standing(x, y, radius, z - half, z + half)
    return found


def supports(stands: dict[str, Standing]) -> dict[str, set[str]]:
    """By object: the objects that it rests on."""
    return {
        name: {other for other, under in stands.items() if other != name and it.rests_on(under)}
        for name, it in stands.items()
    }


def figure(scene: dict) -> tuple[str, set[str]]:
    """The one object that rests on others, and those."""
    above = {name: under for name, under in supports(standing(scene)).items() if under}
    assert len(above) == 1, above
    return next(iter(above.items()))


def replayed(plan: dict):
    """After each step: the step, what it was lifted from under (objects that rested on it), and
    where everything is then (4×4, world from object)."""
    scene = plan["scene"]
    places = {keys["id"]: poses.from_keys(keys) for keys in scene["objects"]}
    for step in plan["steps"]:
        name = step["object"]
        loads = {n for n, under in supports(standing(scene, places)).items() if name in under}
        places = {**places, name: poses.from_keys(step["placed"])}
        yield step, loads, places


def final(plan: dict) -> dict[str, np.ndarray]:
    """Where everything is at the end."""
    places = {keys["id"]: poses.from_keys(keys) for keys in plan["scene"]["objects"]}
    for step in plan["steps"]:
        places[step["object"]] = poses.from_keys(step["placed"])
    return places


def judged(clearway: Clearway, path: Path, fast: bool = True) -> dict:
    """The plan, which the checker and the program's own verifier pass, and which lifts nothing
    from under a load."""
    violations = check_file(path, fast)
    assert not violations, "\n".join(map(str, violations))
    verified = clearway.run("verify", path)
    assert verified.code == SOLVED, verified.out + verified.err
    plan = json.loads(path.read_text())
    for step, loads, _ in replayed(plan):
        assert not loads, f"{step['object']} is lifted from under {loads}"
    return plan
