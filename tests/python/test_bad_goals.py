"""Goals, domains, streams and scenes that are wrong: exit code 2, and an error at its place."""

import re

import pytest

import base_scene
from bad_input import SECONDS
from clearway_cli import BAD_INPUT, SOLVED, Done

GARBAGE = [b"\x7fELF\x02\x01\x01\0\0\xff\xfe" * 99, bytes(range(256)), b"", b" \n\t\n", b"\0" * 64]
NAMES = ["elf", "all-bytes", "empty", "space", "zeros"]


@pytest.fixture(scope="module")
def built_in(clearway) -> dict[str, str]:
    """The program's own texts, by option."""
    return {f"--{name}": clearway.run("pddl", name).out for name in ("domain", "streams")}


def told(clearway, folder, *options, scene: dict | None = None) -> Done:
    """Exit code 2, soon; nothing is written."""
    path, plan = base_scene.write(folder, scene or base_scene.scene()), folder / "plan.json"
    page = folder / "page.html"
    done = clearway.run(
        "plan", path, "-o", plan, "--html", page, "--time-limit", 10, *options, seconds=SECONDS
    )
    assert done.code == BAD_INPUT, f"exit code {done.code}\n{done.err}"
    assert not plan.exists() and not page.exists(), "something was written"
    assert done.err.startswith("error: "), done.err
    return done


def refused(clearway, folder, option: str, text, *words, at=None, more=()) -> Done:
    """`text` in a file for `option`; the error is at `at` (line, column; True: anywhere in it)."""
    file = folder / f"{option.strip('-')}.pddl"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    done = told(clearway, folder, option, file, *more)
    assert file.name in done.err, done.err
    for word in words:
        assert word in done.err, f"does not say {word!r}:\n{done.err}"
    if at is not None:
        found = re.search(rf"{re.escape(file.name)}:(\d+):(\d+): ", done.err)
        assert found, f"names no place:\n{done.err}"
        assert at is True or tuple(map(int, found.groups())) == at, done.err
    return done


def place_of(text: str, part: str) -> tuple[int, int]:
    """Line and column, from 1, of the only `part` in the text."""
    assert text.count(part) == 1, part
    before = text[: text.index(part)].split("\n")
    return len(before), len(before[-1]) + 1


# --- goals --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text, at, words",
    [
        ("; a goal\n(and (On wanted tray)\n", (2, 1), ["not closed", "`)`"]),
        ("(On wanted tray)\n  )", (2, 3), ["`)`"]),
        ("(On wanted tray) (On wanted tray)", (1, 18), []),
        ("wanted", (1, 1), []),
        ("(and\n  (Onn wanted tray))", (2, 4), ["unknown predicate `Onn`", "did you mean `On`"]),
        ("(On\n wantd tray)", (2, 2), ["unknown name `wantd`", "did you mean `wanted`"]),
        ("(On wanted trays)", (1, 12), ["`trays`", "did you mean `tray`"]),
        ("(On ?o tray)", (1, 5), ["unknown variable `?o`"]),
        ("(exists (?o - itm) (On ?o tray))", (1, 15), ["unknown type `itm`", "`item`"]),
        ("(On wanted)", (1, 1), ["`On`", "1 argument", "expected 2"]),
        ("(On tray wanted)", (1, 5), ["`tray`", "`place`", "`item`"]),
        ("(forall (?o - item))", True, ["forall"]),
        ("(not (On wanted tray) (InPlace wanted))", True, ["not"]),
        ("(when (HandEmpty) (On wanted tray))", True, ["when"]),
    ],
)
def test_bad_goal(clearway, tmp_path, text, at, words):
    refused(clearway, tmp_path, "--goal", text, *words, at=at)


def test_bad_goal_on_the_command_line(clearway, tmp_path):
    done = told(clearway, tmp_path, "--goal", "(and (On wanted tray) (On wantd tray))")
    assert "--goal:1:27" in done.err and "`wantd`" in done.err, done.err


@pytest.mark.parametrize(
    "goal",
    [
        "(and (On wanted tray) (not (On wanted tray)))",
        "(and (or (InPlace wanted)) (forall (?o - item) (not (InPlace ?o))))",
        "(or)",
        "(not (and))",
    ],
)
def test_goal_against_itself(clearway, tmp_path, goal):
    done = refused(clearway, tmp_path, "--goal", goal, at=True)
    assert "contradicts itself" in done.err or "never holds" in done.err, done.err


@pytest.mark.parametrize("option", ["--goal", "--domain", "--streams"])
@pytest.mark.parametrize("data", GARBAGE, ids=NAMES)
def test_garbage(clearway, tmp_path, option, data):
    more = () if option == "--goal" else ("--symbolic",)
    refused(clearway, tmp_path, option, data, at=True, more=more)


@pytest.mark.parametrize("option", ["--goal", "--domain", "--streams"])
def test_no_such_file(clearway, tmp_path, option):
    more = () if option == "--goal" else ("--symbolic",)
    done = told(clearway, tmp_path, option, tmp_path / "nobody.pddl", *more)
    assert "nobody.pddl" in done.err and "no such file" in done.err
    done = told(clearway, tmp_path, option, tmp_path, *more)
    assert "directory" in done.err


@pytest.mark.parametrize("text", ["(not " * 10**5, "(and " + "(HandEmpty) " * 10**6, "(" * 10**6])
def test_monsters(clearway, tmp_path, text):
    refused(clearway, tmp_path, "--goal", text)


# --- domains and streams ------------------------------------------------------------------------

DOMAIN_FAULTS = [
    ("(:types", "(:types (", "not closed", None),
    ("(Kin ?o ?p ?g ?w)", "(Kim ?o ?p ?g ?w)", "did you mean `Kin`", "Kim"),
    ("(Kin ?o ?p ?g ?w)", "(Kin ?o ?p ?g)", "3 arguments", "(Kin ?o ?p ?g) "),
    ("(Kin ?o ?p ?g ?w)", "(Kin ?o ?p ?g ?v)", "unknown variable `?v`", "?v"),
    ("(Home ?o - item", "(Home ?o - itm", "did you mean `item`", "itm"),
    (":derived-predicates", ":durative-actions", ":durative-actions", ":durative-actions"),
    (
        "(:action pick\n    :parameters",
        "(:action pick\n    :paramaters",
        "`:parameters`",
        ":paramat",
    ),
    ("(:action place", "(:action pick", "pick", None),
    ("(:predicates", "(:functions (cost))\n  (:predicates", "not supported", ":functions"),
]
STREAM_FAULTS = [
    (":outputs (?g - grasp)", ":outputs (?g - grasp))", "`)`", None),
    ("sample-grasp", "sample-grip", "unknown stream `sample-grip`", "sample-grip"),
    (":certified (Grasp ?o ?g)", ":certified (Grasps ?o ?g)", "did you mean `Grasp`", "Grasps"),
    (":outputs (?g - grasp)", ":outputs (?g - grab)", "unknown type `grab`", "grab)"),
    (":fluents (AtPose)", ":fluents (AtPoser)", "`AtPoser`", "AtPoser"),
    (":certified (CFreePose ?o ?p ?o2 ?p2)", ":certified (CFreePose ?o ?p ?o3 ?p2)", "?o3", "?o3"),
    (":outputs (?m - motion)", ":outputs (?m ?n - motion)", "plan-motion", None),
]


@pytest.mark.parametrize(
    "option, old, new, word, part",
    [("--domain", *fault) for fault in DOMAIN_FAULTS]
    + [("--streams", *fault) for fault in STREAM_FAULTS],
    ids=lambda value: value.replace("\n", " ") if value and len(value) < 40 else "",
)
def test_a_fault_in_a_domain_or_in_streams(
    clearway, tmp_path, built_in, option, old, new, word, part
):
    text = built_in[option]
    assert old in text, f"{old!r} is not in what the program prints"
    text = text.replace(old, new, 1)
    at = place_of(text, part) if part else True
    refused(clearway, tmp_path, option, text, word, at=at, more=["--symbolic"])


def test_one_for_the_other(clearway, tmp_path, built_in):
    for option, other in (("--domain", "--streams"), ("--streams", "--domain")):
        refused(clearway, tmp_path, option, built_in[other], at=True, more=["--symbolic"])


def test_a_constant_that_is_no_object(clearway, tmp_path, built_in):
    """A typing error here would quietly protect nothing."""
    text = built_in["--domain"].replace("(:predicates", "(:constants wantd - item)\n(:predicates")
    refused(clearway, tmp_path, "--domain", text, "wantd", at=True, more=["--symbolic"])


# --- options and scenes -------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [["--goal", "(On wanted tray)"], ["--symbolic"]])
def test_what_does_not_go_together(clearway, tmp_path, kind):
    assert "--improve" in told(clearway, tmp_path, *kind, "--improve", 1).err
    scene = base_scene.scene()
    scene["camera"] = {"position": [0.0, 0.0, 1.2], "look_at": [0.9, 0.0, 0.7], "fov": 1.2}
    assert "camera" in told(clearway, tmp_path, *kind, scene=scene).err


def test_goal_or_symbolic(clearway, tmp_path):
    done = told(clearway, tmp_path, "--symbolic", "--goal", "(On wanted tray)")
    assert "--goal" in done.err and "--symbolic" in done.err


def test_another_engine_that_is_not_there(clearway, tmp_path):
    done = told(clearway, tmp_path, "--symbolic", "--fast-downward", tmp_path / "nobody.py")
    assert "nobody.py" in done.err


def short_on(aside: float, height: float) -> dict:
    """The base scene with a short one at so many metres from the middle of `near_left`'s top."""
    scene = base_scene.scene()
    z = base_scene.FLOOR + base_scene.HEIGHT + 0.05 + height
    shape = {"radius": 0.03, "height": 0.1}
    scene["objects"].append({"id": "short", "cylinder": shape, "position": [0.78 - aside, 0.12, z]})
    return scene


@pytest.mark.parametrize("kind", [[], ["--goal", "(On wanted tray)"], ["--symbolic"]])
@pytest.mark.parametrize(
    "aside, height, word",
    [(0.045, 0.0, "not stable"), (0.0, 0.003, "floats"), (0.2, 0.0, "floats")],
    ids=["unstable", "a little above", "on nothing"],
)
def test_what_does_not_stand(clearway, tmp_path, aside, height, word, kind):
    done = told(clearway, tmp_path, *kind, scene=short_on(aside, height))
    assert "`short`" in done.err and word in done.err, done.err
    scene = (tmp_path / "scene.yaml").read_text()
    assert base_scene.line_of(scene, '"short"') in done.lines_named("scene.yaml"), done.err


def test_what_stands_there_is_planned_for(clearway, tmp_path):
    """The same, moved to where it stands."""
    path = base_scene.write(tmp_path, short_on(0.03, 0.0))
    done = clearway.run("plan", path, "--symbolic", "-o", tmp_path / "plan.json")
    assert done.code == SOLVED, done.err
