"""A printed number against a computed one, with its tolerance and, where it is missed, the reason."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from swamp_rl.experiments.reports.experiment import table


class Judged(Protocol):
    """A printed number with ours beside it; the fields are those of `Check`."""

    @property
    def what(self) -> str: ...
    @property
    def source(self) -> str: ...
    @property
    def met(self) -> bool: ...
    @property
    def reason(self) -> str: ...
    @property
    def reading_of(self) -> str: ...
    @property
    def contradicted(self) -> bool: ...


@dataclass(frozen=True)
class Check:
    """A printed number, or the ends of a printed range; ours; what is tolerated; why it is missed.

    share: of the number; width: as a difference instead, such as half a unit of the last printed digit; the
    wider one counts. reading_of: the printed number that this is one of several readings of; else its own.
    contradicted: by another number or equation that the same source prints, as the reason says.
    """

    what: str
    source: str
    printed: str
    low: float
    high: float
    ours: float
    share: float
    width: float = 0.0
    reason: str = ""
    reading_of: str = ""
    contradicted: bool = False

    @property
    def off(self) -> float:
        """Ours less the printed number, or less the nearer end of its range; 0 within the range."""
        return max(self.ours - self.high, 0.0) + min(self.ours - self.low, 0.0)

    @property
    def met(self) -> bool:
        """Whether ours is within the tolerance."""
        nearer = self.high if self.off > 0.0 else self.low
        return abs(self.off) <= max(self.share * abs(nearer), self.width) + 1e-12

    @property
    def cells(self) -> list[str]:
        """For the table."""
        message = [f"{100 * self.share:g} %"] if self.share else []
        message += [f"{self.width:g}"] if self.width else []
        ours = f"{self.ours:.4g}" if abs(self.ours) >= 1000.0 else f"{self.ours:.3g}"
        verdict = "met" if self.met else "**missed**"
        return [self.what, self.source, self.printed, ours, " or ".join(message), verdict]


def check(
    what: str,
    source: str,
    printed: float,
    ours: float,
    share: float,
    width: float = 0.0,
    reason: str = "",
    reading_of: str = "",
    contradicted: bool = False,
) -> Check:
    """A check of one printed number."""
    text = f"{printed:g}"
    return Check(what, source, text, printed, printed, ours, share, width, reason, reading_of, contradicted)


def check_table(checks: Sequence[Check]) -> str:
    """Printed numbers against ours."""
    return table(
        ["number", "source", "printed", "ours", "tolerance", "result"], [one.cells for one in checks]
    )


def number_of(one: Judged) -> str:
    """The printed number that this is a reading of."""
    return f"{one.reading_of or one.what}, {one.source}"


def reasons(checks: Sequence[Judged]) -> str:
    """A sentence for each printed number that no reading meets."""
    met = {number_of(one) for one in checks if one.met}
    missed = {number_of(one): one.reason for one in checks if number_of(one) not in met}
    return "\n".join(f"* {number}: {reason}" for number, reason in missed.items())


def count(checks: Sequence[Judged]) -> tuple[int, int, int]:
    """How many printed numbers there are, how many of them some reading meets, and how many their own source
    contradicts of those that none meets.
    """
    numbers = {number_of(one) for one in checks}
    met = {number_of(one) for one in checks if one.met}
    contradicted = {number_of(one) for one in checks if one.contradicted}
    return len(numbers), len(met), len(contradicted - met)


def count_table(groups: Mapping[str, Sequence[Judged]], head: str = "design") -> str:
    """Numbers, how many are met, and how many of the others their source contradicts, by group and in all."""
    counts = {name: count(checks) for name, checks in groups.items()}
    counts["all"] = tuple(map(sum, zip(*counts.values(), strict=True)))  # type: ignore[assignment]
    rows = [
        [name, str(n), str(met), share(met, n), str(against), share(met, n - against)]
        for name, (n, met, against) in counts.items()
    ]
    columns = [head, "printed numbers", "within the tolerance", "share", "missed, their source contradicts"]
    return table([*columns, "share of the others"], rows)


def share(part: int, whole: int) -> str:
    """In percent for a table, a dash of nothing."""
    return f"{100 * part / whole:.0f} %" if whole else "–"
