"""One odd thing about a dataset."""

from dataclasses import asdict, dataclass, field
from typing import Any, Literal

Level = Literal["fault", "note"]


@dataclass(frozen=True)
class Finding:
    """`fault`: the data contradict themselves or the boat; `note`: a property that limits what they can show.

    code: the check's name for it; columns: which it concerns; runs: in which, empty for all; message: what
    was found, with figures; advice: what to do; figures: the statistics, SI.
    """

    level: Level
    code: str
    columns: tuple[str, ...]
    message: str
    advice: str
    runs: tuple[str, ...] = ()
    figures: dict[str, float] = field(default_factory=dict)

    @property
    def distinct_runs(self) -> list[str]:
        """Names of runs, each once: parts of a run have its name."""
        return list(dict.fromkeys(self.runs))

    def __str__(self) -> str:
        runs = self.distinct_runs[:6]
        where = f"{', '.join(self.columns)}" + (f" ({', '.join(runs)})" if runs else "")
        return f"{self.level}: {self.code}: {where}: {self.message}; {self.advice}"

    def as_json(self) -> dict[str, Any]:
        """Plain types."""
        return asdict(self) | {"columns": list(self.columns), "runs": self.distinct_runs}
