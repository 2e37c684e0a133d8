"""What every test of bad input asks: exit code 2, soon, with an error that helps."""

from pathlib import Path

from clearway_cli import BAD_INPUT, Clearway, Done

SECONDS = 10.0


def plan_text(clearway: Clearway, folder: Path, text, *more) -> tuple[Done, Path]:
    """Plans a scene given as text or bytes, with no more than ten seconds."""
    scene, plan = folder / "scene.yaml", folder / "plan.json"
    if text is not None:
        data = text if isinstance(text, bytes) else text.encode()
        scene.write_bytes(data)
    return clearway.run("plan", scene, "--seed", 1, "-o", plan, *more, seconds=SECONDS), plan


def refused(clearway, folder, text, *words: str, file: str = "scene.yaml", line=None) -> Done:
    """Exit code 2; stderr names `file`, its `line` (True: any) and `words`; nothing is written."""
    done, plan = plan_text(clearway, folder, text)
    assert done.code == BAD_INPUT, f"exit code {done.code}\n{done.err}"
    assert not plan.exists(), "a plan was written"
    assert file in done.err, f"does not name {file}:\n{done.err}"
    for word in words:
        assert word in done.err, f"does not say {word!r}:\n{done.err}"
    if line is not None:
        lines = done.lines_named(file)
        assert lines, f"names no line:\n{done.err}"
        assert line is True or line in lines, f"line {line} expected, not {lines}:\n{done.err}"
    return done
