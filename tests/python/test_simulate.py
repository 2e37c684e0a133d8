"""`clearway simulate`: plans played in a physics engine, what spoils them, noise, bad input."""

import json

import pytest

from clearway_cli import BAD_INPUT, SOLVED, VIOLATIONS
from scenes import generated

ELSEWHERE = VIOLATIONS
"""The exit code when not everything ends as planned."""


def planned(clearway, folder, seed: int, option: str):
    scene, path = generated(clearway, folder, "shelf", 12, seed), folder / "plan.json"
    clearway.solve(scene, path, option)
    return path


@pytest.fixture(scope="module")
def picked(clearway, tmp_path_factory):
    """A plan of two picks."""
    return planned(clearway, tmp_path_factory.mktemp("picked"), 2, "--no-push")


@pytest.fixture(scope="module")
def pushed(clearway, tmp_path_factory):
    """A plan of a push and a pick."""
    return planned(clearway, tmp_path_factory.mktemp("pushed"), 5, "--prefer-push")


@pytest.fixture
def spoilt(picked, tmp_path):
    """Writes a plan that was changed by a function."""

    def write(change, of=picked):
        plan = json.loads(of.read_text())
        change(plan)
        path = tmp_path / "spoilt.json"
        path.write_text(json.dumps(plan))
        return path

    return write


def report(clearway, path, *more, code: int = SOLVED) -> dict:
    done = clearway.run("simulate", path, "--json", *more)
    assert done.code == code, done.out + done.err
    return json.loads(done.out)


def ended(told: dict) -> dict[str, dict]:
    return {end["object"]: end for end in told["ends"]}


# --- as planned ---------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["picked", "pushed"])
def test_a_good_plan(clearway, request, kind):
    path = request.getfixturevalue(kind)
    plan = json.loads(path.read_text())
    done = clearway.run("simulate", path)
    assert done.code == SOLVED and done.out.startswith("ends as planned"), done.out + done.err
    told = report(clearway, path)
    assert told["as_planned"] and not told["touched"] and not told["touches"]
    ends = ended(told)
    assert set(ends) == {keys["id"] for keys in plan["scene"]["objects"]}
    assert {name for name, end in ends.items() if end["moved"]} == set(plan["removed"])
    for end in ends.values():
        assert not end["elsewhere"] and not end["fallen"]
        assert end["distance"] <= (0.010 if end["moved"] else 0.005)
    for step in plan["steps"]:
        assert ends[step["object"]]["expected"] == pytest.approx(step["placed"]["position"])
    assert ("push" in {step["action"] for step in plan["steps"]}) == (kind == "pushed")


# --- elsewhere ----------------------------------------------------------------------------------


def target_aside(plan):
    """3 cm."""
    target = plan["scene"]["target"]
    keys = next(keys for keys in plan["scene"]["objects"] if keys["id"] == target)
    keys["position"][1] += 0.03


def never_closes(plan):
    for step in plan["steps"]:
        for segment in step["segments"]:
            segment["gripper"] = {"finger_joint": 0.0}


def pushed_farther(plan):
    """Than the hand goes: by 3 cm."""
    step = next(step for step in plan["steps"] if step["action"] == "push")
    for i, along in enumerate(step["push"]["direction"]):
        step["placed"]["position"][i] += 0.03 * along


def test_the_target_stands_aside(clearway, spoilt):
    path = spoilt(target_aside)
    told = report(clearway, path, code=ELSEWHERE)
    target = json.loads(path.read_text())["scene"]["target"]
    assert not told["as_planned"] and ended(told)[target]["elsewhere"]
    done = clearway.run("simulate", path)
    assert done.code == ELSEWHERE and "elsewhere" in done.out and target in done.out, done.out


def test_a_hand_that_never_closes(clearway, spoilt):
    """Nothing is carried, if the plan has the fingers open all the time."""
    path = spoilt(never_closes)
    told = report(clearway, path, code=ELSEWHERE)
    moved = [end for end in ended(told).values() if end["moved"]]
    assert moved and all(end["elsewhere"] for end in moved)


def test_a_push_that_goes_less_far(clearway, spoilt, pushed):
    told = report(clearway, spoilt(pushed_farther, of=pushed), code=ELSEWHERE)
    far = [end["distance"] for end in ended(told).values() if end["elsewhere"]]
    assert far == [pytest.approx(0.03, abs=0.005)]


def test_tolerance(clearway, picked):
    """With less tolerance than there is physics, what was moved is elsewhere."""
    told = report(clearway, picked, "--tolerance", 1e-9, code=ELSEWHERE)
    ends = ended(told).values()
    assert {end["object"] for end in ends if end["elsewhere"]} == {
        end["object"] for end in ends if end["moved"]
    }


# --- noise --------------------------------------------------------------------------------------


def test_trials(clearway, pushed):
    """A rate in words; every trial in the report; the same twice, whatever the threads."""
    noise = ("--noise", 0.002, "--trials", 5)
    done = clearway.run("simulate", pushed, *noise, "--seed", 1)
    assert done.code in (SOLVED, ELSEWHERE), done.err
    first, _, rest = done.out.partition(" trials end as planned (")
    good = int(first.removesuffix(" of 5"))
    assert rest.startswith(f"{100 * good / 5:.1f} %"), done.out
    assert (done.code == SOLVED) == (good == 5)
    texts = [
        clearway.run("simulate", pushed, *noise, "--seed", 1, "--threads", threads, "--json").out
        for threads in (1, 2)
    ]
    assert texts[0] == texts[1]
    told = json.loads(texts[0])
    assert told["seed"] == 1 and told["noise"]["position"] == 0.002
    assert told["as_planned"] == good and len(told["trials"]) == 5
    outcomes = [trial["outcome"] for trial in told["trials"]]
    assert sum(outcome["as_planned"] for outcome in outcomes) == good
    expected = [ended(outcome)["o1"]["expected"] for outcome in outcomes]
    assert len({tuple(at) for at in expected}) == 5, "every trial has noise of its own"


def test_another_seed_is_other_noise(clearway, picked):
    places = []
    for seed in (1, 1, 2):
        done = clearway.run("simulate", picked, "--noise", 0.002, "--seed", seed, "--json")
        told = json.loads(done.out)
        ends = ended(told["trials"][0]["outcome"] if "trials" in told else told)
        places.append(ends["o1"]["expected"])
    assert places[0] == places[1] != places[2]


# --- bad input ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "options, word",
    [
        (["--noise", "-0.001"], "noise"),
        (["--noise", "nan"], "noise"),
        (["--noise", "5"], "noise"),
        (["--noise-friction", "-0.1"], "friction"),
        (["--noise-radius", "-1"], "radius"),
        (["--trials", "0"], "trials"),
        (["--trials", "-3"], "-3"),
        (["--trials", "many"], "trials"),
        (["--rate", "0"], "rate"),
        (["--lag", "-1"], "lag"),
        (["--grip", "-5"], "grip"),
        (["--rubber", "nan"], "rubber"),
        (["--tolerance", "-1"], "tolerance"),
    ],
    ids=" ".join,
)
def test_bad_options(clearway, picked, options, word):
    done = clearway.run("simulate", picked, *options, seconds=10)
    assert done.code == BAD_INPUT and word in done.err and not done.out, done.err


def no_steps(plan):
    plan["steps"] = []


def without_steps(plan):
    del plan["steps"]


def not_solved(plan):
    plan["status"], plan["steps"] = "out_of_budget", []


def of_nobody(plan):
    plan["steps"][0]["object"] = "nobody"


def a_short_row(plan):
    plan["steps"][0]["segments"][0]["positions"][0] = [1.0]


def no_number(plan):
    plan["steps"][0]["segments"][0]["positions"][0][0] = None


def no_robot(plan):
    plan["robot"]["urdf"] = "<robot"


@pytest.mark.parametrize(
    "change, words",
    [
        (no_steps, ["0 steps"]),
        (without_steps, ["steps"]),
        (not_solved, ["out_of_budget"]),
        (of_nobody, ["nobody", "step 0"]),
        (a_short_row, ["step 0", "segment 0", "row 0", "6"]),
        (no_number, ["null"]),
        (no_robot, ["robot.urdf"]),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_plans_that_make_no_sense(clearway, spoilt, change, words):
    done = clearway.run("simulate", spoilt(change), seconds=10)
    assert done.code == BAD_INPUT and not done.out, done.out
    assert all(word in done.err for word in ["spoilt.json", *words]), done.err


@pytest.mark.parametrize("text", ["", "hello", "[]", "{}", "format: clearway-scene/1\n"])
def test_not_a_plan(clearway, tmp_path, text):
    path = tmp_path / "words.json"
    path.write_text(text)
    done = clearway.run("simulate", path, seconds=10)
    assert done.code == BAD_INPUT and "words.json" in done.err, done.err


def test_no_such_file(clearway, tmp_path):
    done = clearway.run("simulate", tmp_path / "none.json", seconds=10)
    assert done.code == BAD_INPUT and "none.json" in done.err, done.err
