"""Plays many generated scenes: `python -m mujoco_player.measure BINARY [options]`.

Each seed: `generate`, `plan`, `play`. Prints a line of JSON for each as it ends (`--out`: into a
file), then a table: how many ended as planned, what the arm touched, how fast it went.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from . import play


def main(arguments: list[str] | None = None) -> int:
    """The command line; returns the exit code: 0 if every plan was found and played."""
    parser = argparse.ArgumentParser(prog="mujoco_player.measure", description=__doc__)
    parser.add_argument("binary", type=Path)
    parser.add_argument("--kind", default="shelf")
    parser.add_argument("--objects", type=int, default=12)
    parser.add_argument("--seeds", default="1-60", help="first-last")
    parser.add_argument("--noise", type=float, default=0.0, help="metres")
    parser.add_argument("--option", action="append", default=[], help="of `plan`; repeatable")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--keep", type=Path, help="a folder for scenes and plans")
    parser.add_argument("--out", type=Path, help="JSON lines go here instead of to stdout")
    options = parser.parse_args(arguments)
    first, _, last = options.seeds.partition("-")
    seeds = range(int(first), int(last or first) + 1)
    rows, out = [], options.out.open("w") if options.out else sys.stdout
    with ProcessPoolExecutor(options.processes) as pool:
        for row in pool.map(one, seeds, [options] * len(seeds)):
            rows.append(row)
            print(json.dumps(row), file=out, flush=True)
    print(table(rows))
    return 0 if all("as_planned" in row for row in rows) else 1


def one(seed: int, options) -> dict:
    """One seed, from the scene to the end of the motion."""
    with tempfile.TemporaryDirectory() as folder:
        folder = options.keep or Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        scene, path = folder / f"{options.kind}-{seed}.yaml", folder / f"{options.kind}-{seed}.json"
        made = ["generate", options.kind, "--objects", options.objects, "--seed", seed]
        for command in (
            [*made, "-o", scene],
            ["plan", scene, "--seed", seed, "-o", path, *options.option],
        ):
            words = [str(word) for word in (options.binary.resolve(), *command)]
            done = subprocess.run(words, capture_output=True, text=True, timeout=300)
            if done.returncode:
                return {"seed": seed, "command": command[0], "exit": done.returncode}
        plan = json.loads(path.read_text())
        return {"seed": seed, **summary(plan, play(plan, seed=seed, noise=options.noise))}


def summary(plan: dict, played) -> dict:
    """What is kept of one run."""
    ends = [step for step in played.steps if step.slip is not None]
    return {
        "as_planned": played.as_planned,
        "target": played.objects[plan["scene"]["target"]].as_planned,
        "steps": [f"{step.object}:{step.action}" for step in played.steps],
        "arm_newtons": round(played.arm_force, 2),
        "other_newtons": round(
            max((c.force for c in played.contacts if not c.of_arm), default=0), 2
        ),
        "moved_mm": _millimetres(o.error for o in played.objects.values() if o.moved),
        "untouched_mm": _millimetres(o.error for o in played.objects.values() if not o.moved),
        "fallen": [name for name, ended in played.objects.items() if ended.fell],
        "step_mm": [round(1e3 * step.error, 2) for step in played.steps],
        "slip_mm": _millimetres(step.slip for step in ends),
        "tracking_mm": round(1e3 * played.tracking, 2),
        "motion_s": round(played.motion, 2),
        "wall_s": round(played.wall, 2),
        "faults": played.faults(),
    }


def _millimetres(values) -> float:
    return round(1e3 * max(values, default=0.0), 2)


def table(rows: list[dict]) -> str:
    """The rows in sum."""
    played = [row for row in rows if "as_planned" in row]
    if not played:
        return "nothing was played"
    ended = sum(row["as_planned"] for row in played)
    target = sum(row["target"] for row in played)
    motion, wall = (sum(row[key] for row in played) for key in ("motion_s", "wall_s"))
    lines = [
        f"plans            {len(played)} of {len(rows)}",
        f"as planned       {ended} ({100 * ended / len(played):.1f} %)",
        f"target in place  {target}",
        f"arm above 1 N    {sum(row['arm_newtons'] > 1.0 for row in played)} plans",
        f"others above 1 N {sum(row['other_newtons'] > 1.0 for row in played)} plans",
    ]
    for key in ("moved_mm", "untouched_mm", "slip_mm", "tracking_mm", "arm_newtons"):
        values = sorted(row[key] for row in played)
        lines.append(f"{key:16} median {values[len(values) // 2]:.2f}  most {values[-1]:.2f}")
    lines.append(f"wall per second of motion {wall / motion:.2f} s ({motion:.0f} s of motion)")
    bad = [row["seed"] for row in played if not row["as_planned"] or row["arm_newtons"] > 1.0]
    return "\n".join([*lines, f"seeds to look at {bad}"])


if __name__ == "__main__":
    sys.exit(main())
