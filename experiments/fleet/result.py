"""The models of `fleet.json`; `schema_text(Fleet, TITLE)` is its published schema.

python -m swamp_rl.experiments.fleet.result docs/fleet.schema.json
"""

import sys
from pathlib import Path
from typing import Literal

from pydantic import Field

from swamp_rl.criticism.result import Estimate, Part, Verdict
from swamp_rl.files import write_text
from swamp_rl.json_text import schema_text

TITLE = "fleet.json of swamp-rl fleet"


class MemberCause(Part):
    """A cause in one dataset. cause: its label; weather: whether it is none of the boat's; scope: whether all
    runs share the parameters, or these are the means of every day's or run's own. A force curve has none.
    """

    cause: str
    weather: bool = False
    scope: Literal["boat", "day", "run"] = "boat"
    parameters: dict[str, Estimate] = Field(default={})


class PositionError(Part):
    """Root mean square position error [m] at a horizon on held-out runs, of the boat file and of the extended
    boat.
    """

    horizon_s: float
    before: float
    after: float


class Member(Part):
    """One dataset. name: of its folder in the fleet's; boat: whose it is; boat_file: what it was compared
    with; verdict: none where it was refused or failed, `error` says why; minor, indistinguishable: as in its
    diagnosis; position_error: at the longest horizon that all datasets have, or the longest of its own;
    warning: that the boat file predicts no better than a trivial predictor.
    """

    name: str
    boat: str
    dataset: str
    boat_file: str | None = None
    verdict: Verdict | None = None
    causes: list[MemberCause] = Field(default=[])
    minor: list[MemberCause] = Field(default=[])
    indistinguishable: list[list[str]] = Field(default=[])
    position_error: PositionError | None = None
    warning: str | None = None
    error: str | None = None


class BoatCauses(Part):
    """What a boat has of its own, the weather left out. causes: kept in one of its datasets; lesser: those
    that are minor or not kept wherever they are found.
    """

    boat: str
    causes: list[str]
    lesser: list[str]


class Finding(Part):
    """A cause in one dataset. p: its p-value, see `significance`; kept: whether it stands at the false
    discovery rate of the fleet.
    """

    name: str
    boat: str
    cause: str
    p: float
    kept: bool


class SharedCause(Part):
    """A kept cause and the boats that have it. in_boat_file: whether it is rather an error of the boat file
    than a fault of each: most of three or more boats have it, all were compared with the same numbers, and
    no boat is without it in which it would show.
    """

    cause: str
    boats: list[str]
    in_boat_file: bool = False


class Drift(Part):
    """A parameter of one boat's cause that differs between its datasets beyond its standard errors.

    values, standard_errors: by dataset; p: of equal values (Cochran's Q), adjusted by Benjamini and Hochberg.
    """

    boat: str
    cause: str
    parameter: str
    unit: str
    values: dict[str, float]
    standard_errors: dict[str, float]
    p: float


class Change(Part):
    """A kept cause that one boat has in some of its datasets and not in others. absent_in: those that name
    neither it, not even as minor, nor what it cannot be distinguished from.
    """

    boat: str
    cause: str
    found_in: list[str]
    absent_in: list[str]


class Fleet(Part):
    """The fleet. rate: the false discovery rate that the findings are held at; tests: how many p-values it
    counts; boats: those with causes first, those without last; weather: kept effects of weather, which
    `shared`, `drifts` and `changes` leave out; measured: seconds of each dataset, the only part that depends
    on when and where it was done.
    """

    version: str
    rate: float
    tests: int
    boats: list[BoatCauses]
    members: list[Member]
    findings: list[Finding]
    shared: list[SharedCause]
    weather: list[SharedCause]
    drifts: list[Drift]
    changes: list[Change]
    measured: dict[str, float]


def main() -> None:
    """Write the schema to the file named on the command line."""
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        raise SystemExit(__doc__)
    write_text(Path(sys.argv[1]), schema_text(Fleet, TITLE))


if __name__ == "__main__":
    main()
