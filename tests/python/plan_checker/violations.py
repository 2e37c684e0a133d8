"""What is wrong with a plan: one record per finding."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Violation:
    """A broken rule, where in the plan, and what was found."""

    rule: str
    where: str
    text: str

    def __str__(self) -> str:
        return f"[{self.rule}] {self.where}: {self.text}"


class PlanError(Exception):
    """The plan cannot be judged further: a key is missing or makes no sense."""


class Report:
    """Collects violations; `LIMIT` of each rule, then only their number."""

    LIMIT = 40

    def __init__(self) -> None:
        self.violations: list[Violation] = []
        self._count: dict[str, int] = {}

    def add(self, rule: str, where: str, text: str) -> None:
        self._count[rule] = self._count.get(rule, 0) + 1
        if self._count[rule] <= self.LIMIT:
            self.violations.append(Violation(rule, where, text))

    def finish(self) -> list[Violation]:
        """All violations; a line more for each rule that had too many."""
        more = [
            Violation(rule, "plan", f"… and {count - self.LIMIT} more")
            for rule, count in self._count.items()
            if count > self.LIMIT
        ]
        return self.violations + more
