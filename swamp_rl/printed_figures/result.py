"""The models of the `diagnosis.json` of printed figures; its causes are those of a diagnosis of runs.
`schema_text(FiguresDiagnosis, TITLE)` is its published schema.

python -m swamp_rl.printed_figures.result docs/figures_diagnosis.schema.json
"""

import sys
from pathlib import Path
from typing import Literal

from pydantic import Field

from swamp_rl.criticism.result import TITLE as OF_RUNS
from swamp_rl.criticism.result import Cause, Part, Verdict
from swamp_rl.files import write_text
from swamp_rl.json_text import schema_text

TITLE = f"{OF_RUNS} on printed figures"


class FigureFound(Part):
    """A printed figure and the boat's prediction of it. off: (value − printed) / error, 0 within a limit.

    use: fitted, judged (held out), or alternative (another reading, not used).
    """

    group: str
    name: str
    mass: float
    unit: str
    printed: float
    error: float
    limit: Literal["at_least", "at_most"] | None
    use: Literal["fitted", "judged", "alternative"]
    boat_file: float
    extended: float
    boat_file_off: float
    extended_off: float
    source: str
    reading: str


class CandidateFound(Part):
    """A set of effects that was fitted. chi2: of the figures; evidence: −2 log of its marginal likelihood,
    above that of the most likely.
    """

    effect: str
    chi2: float
    evidence: float


class RivalFound(Part):
    """A set of effects that the fitted figures do not separate from the most likely. held_out_chi2: of the
    figures that judge it; of_the_first: of the most likely on these; distinguished: whether the two together
    separate them.
    """

    effect: str
    causes: list[Cause]
    evidence: float
    held_out_chi2: float
    of_the_first: float
    distinguished: bool


class StageFound(Part):
    """One stage of the search. without_particulars: sets that the figures alone do not separate; alone: the
    parameters of the most likely set from the figures alone.
    """

    groups: list[str]
    figures: int
    chi2_before: float
    chi2_after: float
    named: list[str]
    adequate: bool
    rivals: list[RivalFound]
    without_particulars: list[str]
    alone: list[Cause]
    candidates: list[CandidateFound]
    unseen: list[str]


class GroupFound(Part):
    """chi2 of a group's figures with the boat file and with the extended boat."""

    group: str
    use: Literal["fitted", "judged"]
    figures: int
    chi2_before: float
    chi2_after: float


class Exchanged(Part):
    """The search with one group fitted in place of another: its causes, and the gain on that other."""

    fitted: str
    judged: str
    named: list[str]
    causes: list[Cause]
    chi2_before: float
    chi2_after: float


class FiguresDiagnosis(Part):
    """The diagnosis. indistinguishable: sets of effects that neither the fitted figures nor those that judge
    them separate; correlation: of the errors of the parameters of `causes`, in their order.
    """

    verdict: Verdict
    causes: list[Cause]
    nuisance: list[Cause] = Field(default_factory=list)
    correlation: list[list[float]]
    indistinguishable: list[list[str]]
    stages: list[StageFound]
    figures: list[FigureFound]
    gain: list[GroupFound]
    exchange: list[Exchanged]
    elapsed_s: float


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        raise SystemExit(__doc__)
    write_text(Path(sys.argv[1]), schema_text(FiguresDiagnosis, TITLE))
