"""`clearway bench motion`: its rows and its summary, its paths checked again, bad input refused."""

import json

import numpy as np
import pytest

import mesh_robot
import motion_checker
import sphere_arm
import user_robots
from bad_input import SECONDS
from clearway_cli import BAD_INPUT, SOLVED

FINER = 4 * 32
"""Looks per radian: four times as many as the planner's own samples."""
ROUNDING = 1e-6
"""Metres that the planner's f32 may lose."""


@pytest.fixture
def files(tmp_path):
    """The arm and ten problems of two sets."""
    problems = sphere_arm.problems(5)
    (tmp_path / "arm.urdf").write_text(sphere_arm.urdf(), encoding="utf-8")
    (tmp_path / "problems.json").write_text(json.dumps(problems), encoding="utf-8")
    return tmp_path, problems


def bench(clearway, folder, *more, seconds=120.0):
    arguments = ("--robot", folder / "arm.urdf", "--problems", folder / "problems.json")
    return clearway.run("bench", "motion", *arguments, *more, seconds=seconds)


def rows_of(done) -> tuple[list[dict], dict]:
    """The rows, and the summary that is stdout's last line."""
    assert done.code == SOLVED, done.err
    *rows, last = map(json.loads, done.out.splitlines())
    assert list(last) == ["summary"]
    return rows, last["summary"]


@pytest.mark.parametrize("cylinders", ["peer", "true"])
def test_paths_are_free(clearway, files, cylinders):
    folder, problems = files
    more = ["--true-cylinders"] if cylinders == "true" else []
    rows, summary = rows_of(bench(clearway, folder, "--repeats", 2, *more))
    assert [(r["set"], r["index"]) for r in rows] == [
        (name, p["index"]) for name, listed in problems["problems"].items() for p in listed
    ]
    arm = motion_checker.SphereRobot(sphere_arm.urdf(), sphere_arm.JOINTS)
    for row in rows:
        problem = problems["problems"][row["set"]][row["index"] - 1]
        assert row["solved"], row
        path = np.array(row["path"])
        assert np.allclose(path[0], problem["start"], atol=1e-9)
        assert min(np.abs(path[-1] - goal).max() for goal in problem["goals"]) < 1e-9
        assert row["cost"] == pytest.approx(motion_checker.length(path), abs=1e-9)
        assert row["cost"] <= row["initial_cost"] + 1e-9
        assert row["plan_us"] > 0 and row["simplify_us"] >= 0
        assert (np.abs(path) <= sphere_arm.LIMITS + 1e-9).all()
        parts = motion_checker.parts_of(problem, cylinders, row["set"] == "box")
        least = arm.clearances(motion_checker.densely(path, FINER), parts).min()
        assert least >= -ROUNDING, f"{row['set']} {row['index']}: {least}"
    assert summary["solved"] == summary["total"] == len(rows) == 10
    assert summary["joints"] == sphere_arm.JOINTS and summary["robot"] == "sphere_arm"
    assert summary["spheres"] == 13
    assert summary["cost"] == pytest.approx(np.mean([r["cost"] for r in rows]))
    plans = [r["plan_us"] for r in rows]
    assert summary["plan_us"]["median"] == pytest.approx(np.median(plans))
    assert summary["plan_us"]["p95"] == pytest.approx(max(plans))
    assert summary["load_ms"] > 0 and summary["level"] and summary["version"]
    assert summary["machine"]["cpu"] and summary["machine"]["cores"] >= 1


def test_the_same_paths_every_time(clearway, files):
    folder, _ = files
    first, second = (
        [r["path"] for r in rows_of(bench(clearway, folder, "--repeats", 1))[0]] for _ in "ab"
    )
    assert first == second


def test_into_a_directory(clearway, files):
    folder, _ = files
    out = folder / "deep" / "results"
    done = bench(clearway, folder, "--repeats", 1, "--out", out)
    assert done.code == SOLVED and done.out == "", done.err
    rows = [json.loads(line) for line in (out / "motion.jsonl").read_text().splitlines()]
    summary = json.loads((out / "summary.json").read_text())["summary"]
    assert len(rows) == summary["total"] == 10
    assert "solved      10 of 10" in done.err
    kept = (out / "motion.jsonl").read_bytes()
    again = bench(clearway, folder, "--repeats", 1, "--out", out)
    assert again.code == BAD_INPUT and "from an earlier run" in again.err
    (out / "summary.json").unlink()
    again = bench(clearway, folder, "--repeats", 1, "--out", out)
    assert again.code == BAD_INPUT and "motion.jsonl" in again.err
    assert (out / "motion.jsonl").read_bytes() == kept


def test_beside_a_peer(clearway, files):
    """A peer made of our own rows, with times and costs known multiples of ours."""
    folder, _ = files
    rows, _ = rows_of(bench(clearway, folder, "--repeats", 1))
    peer = [
        {"set": r["set"], "index": r["index"], "valid": True, "solved": True, "plan_us": 1e6,
         "simplify_us": 1e6, "initial_cost": r["initial_cost"], "cost": 2 * r["cost"]}
        for r in rows[:-1]
    ]  # fmt: skip
    peer.append({"set": rows[-1]["set"], "index": rows[-1]["index"], "valid": False})
    (folder / "peer.json").write_text(json.dumps({"what": "made up", "rows": peer}))
    done = bench(clearway, folder, "--repeats", 1, "--peer", folder / "peer.json")
    rows, summary = rows_of(done)
    found, both = summary["peer"], rows[:-1]
    assert found["peer"] == "made up"
    assert found["solved_by_both"] == found["solved_by_peer"] == 9
    ratios = [(r["plan_us"] + r["simplify_us"]) / 2e6 for r in both]
    assert found["median_ratio"] == pytest.approx(np.median(ratios))
    assert found["plan_p95_ratio"] == pytest.approx(max(r["plan_us"] for r in both) / 1e6)
    assert found["mean_cost"] == pytest.approx(np.mean([r["cost"] for r in both]))
    assert found["peer_mean_cost"] == pytest.approx(2 * found["mean_cost"])
    assert "solved by both" in done.err


def test_what_cannot_be_solved_says_why(clearway, files):
    folder, problems = files
    first, second, third, fourth = problems["problems"]["open"][:4]
    first["start"][2] = 2.6
    ball = {"name": "ball", "radius": 0.05, "position": [0.0, 0.0, 0.3]}
    second["sphere"].append(ball)
    third["goals"] = [[0.0, -9.0, 0.0, 0.0], [0.0, 9.0, 0.0, 0.0]]
    fourth["goals"].insert(0, [9.0, 0.0, 0.0, 0.0])
    (folder / "problems.json").write_text(json.dumps(problems))
    rows, summary = rows_of(bench(clearway, folder, "--repeats", 1))
    assert [r["solved"] for r in rows[:5]] == [False, False, False, True, True]
    assert "start" in rows[0]["why"] and "elbow" in rows[0]["why"] and "2.6" in rows[0]["why"]
    assert "column touches ball" in rows[1]["why"] or "upper touches ball" in rows[1]["why"]
    assert rows[2]["why"].startswith("goal: ") and "-9" in rows[2]["why"]
    assert "why" not in rows[3] and rows[0]["path"] == [] and rows[0]["cost"] is None
    assert summary["solved"] == 7


def nothing(problems):
    problems["problems"]["open"] = problems["problems"]["box"] = []


def with_nan(problems):
    problems["problems"]["open"][0]["sphere"][0]["position"][1] = float("nan")


def without_radius(problems):
    del problems["problems"]["open"][1]["sphere"][0]["radius"]


def negative(problems):
    problems["problems"]["box"][0]["box"][0]["half_extents"][2] = -0.1


def short(problems):
    problems["problems"]["box"][4]["goals"][0].pop()


def no_goals(problems):
    problems["problems"]["box"][4]["goals"] = []


def unknown_joint(problems):
    problems["joints"][1] = "sholder"


@pytest.mark.parametrize(
    "spoil, words",
    [
        (nothing, ["problems.json", "no problems"]),
        (with_nan, ["problems.json:1:", "found `NaN`", "a finite number"]),
        (
            without_radius,
            ["problems.json", "set `open`, problem 2", "`thing0`", "radius is missing"],
        ),
        (negative, ["set `box`, problem 1", "half_extents is -0.1", "positive"]),
        (short, ["set `box`, problem 5", "3 values for 4 joints"]),
        (no_goals, ["set `box`, problem 5", "no goal"]),
        (unknown_joint, ["arm.urdf", "no joint `sholder`", "did you mean `shoulder`"]),
    ],
)
def test_bad_problems(clearway, files, spoil, words):
    folder, problems = files
    spoil(problems)
    (folder / "problems.json").write_text(json.dumps(problems))
    done = bench(clearway, folder, seconds=SECONDS)
    assert done.code == BAD_INPUT and done.out == "", done.err
    for word in words:
        assert word in done.err, done.err


@pytest.mark.parametrize(
    "more, words",
    [
        (["--range", "0"], ["range is 0", "--range"]),
        (["--range", "nan"], ["range is NaN"]),
        (["--checks-per-rad", "0.5"], ["checks per radian are 0.5"]),
        (["--repeats", "0"], ["--repeats"]),
        (["--time-limit=-1"], ["--time-limit"]),
        (["--peer", "none.json"], ["none.json", "no such file"]),
        (["--srdf", "none.srdf"], ["none.srdf", "no such file"]),
        (["--package", "a"], ["NAME=DIR"]),
    ],
)
def test_bad_options(clearway, files, more, words):
    done = bench(clearway, files[0], *more, seconds=SECONDS)
    assert done.code == BAD_INPUT and done.out == "", done.err
    for word in words:
        assert word in done.err, done.err


def test_a_robot_without_shapes_is_refused(clearway, files):
    folder, _ = files
    bare = sphere_arm.urdf().replace("<collision>", "<visual>").replace("</collision>", "</visual>")
    (folder / "arm.urdf").write_text(bare)
    done = bench(clearway, folder, seconds=SECONDS)
    assert done.code == BAD_INPUT and "without a single collision shape" in done.err


def test_a_robot_of_meshes(clearway, tmp_path):
    """The official Panda, its links covered by spheres; paths checked with the meshes."""
    panda = mesh_robot.MeshRobot(
        user_robots.official_urdf("panda_description", "panda.urdf"),
        user_robots.package_folder(),
        [f"panda_joint{i}" for i in range(1, 8)],
    )
    problems = panda.problems(seed=2, count=6)
    (tmp_path / "arm.urdf").write_text(panda.text, encoding="utf-8")
    (tmp_path / "problems.json").write_text(json.dumps(problems))
    package = user_robots.package_folder()
    srdf = package / "robots" / "panda_description" / "srdf" / "panda.srdf"
    more = ("--srdf", srdf, "--package", f"{user_robots.PACKAGE}={package}", "--repeats", 1)
    rows, summary = rows_of(bench(clearway, tmp_path, *more, seconds=300))
    assert summary["joints"] == panda.joints and summary["total"] == 6
    # The spheres are wider than the meshes: a start may be too near to something for them.
    assert summary["solved"] >= 4, [r.get("why") for r in rows]
    for row, problem in zip(rows, problems["problems"]["made_up"]):
        assert row["solved"] or "touches" in row["why"], row
        if row["solved"]:
            assert not panda.touches(motion_checker.densely(row["path"], FINER), problem)
