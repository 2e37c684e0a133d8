"""Timing beside PyPI `toppra`, which knows no limits of jerk: the same curves, the same limits."""

import json
import logging
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from clearway_cli import Clearway
from timing_cases import ROBOTS, Cubics, cases, derivatives, straight_duration, toppra_duration

MOST = 1.15
"""How much longer our motions may take, median."""
MOST_IN_CLUTTER = 1.3
"""The same for whole motions of plans. Tight corners among the clutter must be taken slowly for the
sake of jerk; toppra may change its acceleration there at once."""


@pytest.fixture(scope="module", autouse=True)
def quiet():
    logging.getLogger("toppra").setLevel(logging.ERROR)


def timed(problems: list[dict]) -> list[dict]:
    """Curves and rows from `crates/motion/examples/time_curves.rs`, built beside the program."""
    program = Path(os.environ["CLEARWAY_BIN"]).resolve().parent / "examples" / "time_curves"
    given = json.dumps(problems)
    done = subprocess.run(
        [program], input=given, capture_output=True, text=True, check=True, timeout=60
    )
    return json.loads(done.stdout)


def tell(name: str, ratios) -> None:
    least, low, median, high, most = np.percentile(ratios, [0, 10, 50, 90, 100])
    print(f"\n{name}: {len(ratios)} motions, ours / toppra's: median {median:.3f}", end="")
    print(f" ({least:.3f} … {low:.3f} … {high:.3f} … {most:.3f})")


@pytest.mark.parametrize("robot", ROBOTS)
def test_little_slower_than_without_limits_of_jerk(robot):
    problems = cases(robot, 60, seed=5)
    ratios = []
    for problem, found in zip(problems, timed(problems)):
        velocity, acceleration = problem["velocity"], problem["acceleration"]
        used = derivatives(found["times"], found["rows"])
        for rates, limit in zip(used, ("velocity", "acceleration", "jerk")):
            assert (np.abs(rates) <= np.array(problem[limit]) * (1 + 1e-6)).all(), limit
        borders = [0, *found["stops"], len(found["pieces"])]
        least = sum(
            toppra_duration(
                Cubics(found["knots"][a : b + 1], found["pieces"][a:b]), velocity, acceleration
            )
            for a, b in zip(borders, borders[1:])
        )
        ratios.append(found["times"][-1] / least)
    tell(robot, ratios)
    assert np.median(ratios) <= MOST


@pytest.mark.parametrize("far", [0.05, 0.2, 0.5, 1.0, 2.0, 4.0])
def test_a_straight_line_is_as_fast_as_can_be(far):
    """Beside toppra's time the least possible is 1 + 0.1 s / time: above 1.15 for short lines."""
    velocity, acceleration, jerk = (limit[:1] for limit in ROBOTS["ur10"])
    problem = {"path": [[0.3], [0.3 + far]]}
    problem |= {"velocity": velocity, "acceleration": acceleration, "jerk": jerk}
    found = timed([problem])[0]
    best = straight_duration(far, velocity[0], acceleration[0], jerk[0])
    least = toppra_duration(Cubics(found["knots"], found["pieces"]), velocity, acceleration)
    ours = found["times"][-1]
    print(f"\n{far} rad: {ours:.3f} s, at best {best:.3f} s, toppra {least:.3f} s", end="")
    print(f": {ours / least:.3f}")
    assert 0.97 * best < ours < 1.02 * best


def motions(plan: dict) -> list[tuple[np.ndarray, np.ndarray]]:
    """Times and rows from rest to rest: segments joined where the arm moves on."""
    result, times, rows = [], np.zeros(1), None
    for segment in (s for step in plan["steps"] for s in step["segments"]):
        if segment["kind"] in ("grasp", "release"):
            result, times, rows = [*result, (times, rows)], np.zeros(1), None
            continue
        more, at = np.array(segment["positions"]), np.array(segment["times"])
        rows = more if rows is None else np.vstack([rows, more[1:]])
        times = np.concatenate([times, times[-1] + at[1:]])
    return [*result, (times, rows)]


def through(rows: np.ndarray) -> Cubics:
    """Cubic splines over the length of the rows' path, even enough to have no wrinkles."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(rows, axis=0), axis=1))])
    keep = [0]
    for i in range(1, len(rows) - 1):
        if along[i] - along[keep[-1]] > 0.01 and along[-1] - along[i] > 0.01:
            keep.append(i)
    keep.append(len(rows) - 1)
    spline = CubicSpline(along[keep], rows[keep], bc_type="natural")
    pieces = [spline.c[3], spline.c[2], 2 * spline.c[1], 6 * spline.c[0]]
    return Cubics(spline.x, np.moveaxis(np.array(pieces), 0, 1))


def test_motions_of_plans(clearway: Clearway, tmp_path: Path):
    """Whole motions of the example's plans: to the object, with it, back."""
    scene = Path(__file__).parents[2] / "examples" / "shelf.yaml"
    ratios = []
    for seed in range(1, 5):
        file = tmp_path / f"{seed}.json"
        clearway.solve(scene, file, "--seed", seed)
        plan = json.loads(file.read_text())
        limits = plan["robot"]["limits"]
        velocity, acceleration = (
            [limits[key][joint] for joint in plan["robot"]["joints"]]
            for key in ("velocity", "acceleration")
        )
        for times, rows in motions(plan):
            ratios.append(times[-1] / toppra_duration(through(rows), velocity, acceleration, 1000))
    tell("plans", ratios)
    assert np.median(ratios) <= MOST_IN_CLUTTER
