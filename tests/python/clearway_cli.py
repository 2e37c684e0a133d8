"""Runs the program as a user would, and reads what it says."""

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

SOLVED, VIOLATIONS, BAD_INPUT, IMPOSSIBLE, OUT_OF_BUDGET = 0, 1, 2, 3, 4
"""Exit codes of the contract."""
PANIC_WORDS = ("panicked", "RUST_BACKTRACE", "stack overflow", "overflowed its stack", "Traceback")


@dataclass(frozen=True)
class Done:
    """How a run ended."""

    code: int
    out: str
    err: str

    def lines_named(self, file: str) -> set[int]:
        """The line numbers that stderr names, beside the file (`f:3:7`) or in words (`line 3`)."""
        found = re.findall(rf"{re.escape(file)}:(\d+)|\bline:?\s+(\d+)", self.err, re.IGNORECASE)
        return {int(a or b) for a, b in found}


class Clearway:
    """The binary under test."""

    def __init__(self, binary: Path) -> None:
        self.binary = binary

    def run(self, *arguments, seconds: float = 120.0) -> Done:
        """Runs to the end; longer than `seconds` is a failure, and so is any sign of a panic."""
        command = [str(self.binary), *map(str, arguments)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=seconds, stdin=subprocess.DEVNULL
            )
        except subprocess.TimeoutExpired as error:
            raise AssertionError(f"not done within {seconds} s: {' '.join(command)}") from error
        result = Done(done.returncode, done.stdout, done.stderr)
        for word in PANIC_WORDS:
            assert word not in done.stderr, f"{' '.join(command)}:\n{done.stderr}"
        assert done.returncode >= 0, f"killed by signal {-done.returncode}: {' '.join(command)}"
        return result

    def solve(self, scene: Path, plan: Path, *more, seconds: float = 120.0) -> Done:
        """`clearway plan SCENE -o PLAN`, which must solve the scene."""
        done = self.run("plan", scene, "-o", plan, *more, seconds=seconds)
        assert done.code == SOLVED, f"{scene}: exit code {done.code}\n{done.err}"
        return done
