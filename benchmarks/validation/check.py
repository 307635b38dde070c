"""A printed number against a computed one, with its tolerance and, where it is missed, the reason."""

from collections.abc import Sequence
from dataclasses import dataclass

from swamp_rl.experiments.reports.experiment import table


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
        told = [f"{100 * self.share:g} %"] if self.share else []
        told += [f"{self.width:g}"] if self.width else []
        ours = f"{self.ours:.4g}" if abs(self.ours) >= 1000.0 else f"{self.ours:.3g}"
        verdict = "met" if self.met else "**missed**"
        return [self.what, self.source, self.printed, ours, " or ".join(told), verdict]


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


def reasons(checks: Sequence[Check]) -> str:
    """A sentence for each that is missed."""
    return "\n".join(f"* {one.what}, {one.source}: {one.reason}" for one in checks if not one.met)


def count(checks: Sequence[Check]) -> tuple[int, int, int]:
    """How many printed numbers there are, how many of them some reading meets, and how many their own source
    contradicts of those that none meets.
    """
    met: dict[str, bool] = {}
    contradicted: dict[str, bool] = {}
    for one in checks:
        key = one.reading_of or f"{one.what}, {one.source}"
        met[key] = met.get(key, False) or one.met
        contradicted[key] = contradicted.get(key, False) or one.contradicted
    return len(met), sum(met.values()), sum(contradicted[key] and not met[key] for key in met)


def count_table(groups: dict[str, list[Check]]) -> str:
    """Numbers, how many are met, and how many of the others their source contradicts, by group and in all."""
    counts = {name: count(checks) for name, checks in groups.items()}
    counts["all"] = tuple(map(sum, zip(*counts.values(), strict=True)))  # type: ignore[assignment]
    rows = [
        [name, str(n), str(met), share(met, n), str(against), share(met, n - against)]
        for name, (n, met, against) in counts.items()
    ]
    head = ["design", "printed numbers", "within the tolerance", "share", "missed, their source contradicts"]
    return table([*head, "share of the others"], rows)


def share(part: int, whole: int) -> str:
    """In percent for a table, a dash of nothing."""
    return f"{100 * part / whole:.0f} %" if whole else "–"
