"""Judges plan files from outside: `python check_plan.py PLAN.json… [--fast]`.

Prints every violation; exit code 1 if there is any. As a library: `check_plan.check_file(path)`.
`--fast` checks collisions at the plan's rows only, not in between.
"""

import argparse
import sys

from plan_checker import Violation, check_file, check_plan

__all__ = ["Violation", "check_file", "check_plan", "main"]


def main(arguments: list[str] | None = None) -> int:
    """The command line; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("plans", nargs="+", metavar="PLAN.json")
    parser.add_argument("--fast", action="store_true", help="collisions at rows only")
    options = parser.parse_args(arguments)
    found = 0
    for path in options.plans:
        violations = check_file(path, options.fast)
        found += len(violations)
        for violation in violations:
            print(f"{path}: {violation}")
        if not violations:
            print(f"{path}: no violations")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
