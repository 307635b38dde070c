"""Confounded cases: runs that leave several causes equally good, and one more run that is designed."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.synthetic.cases import (
    DT,
    EFFECTS,
    PLAIN,
    RTK,
    STEADY,
    Array,
    Case,
    Rng,
    Voyage,
    measure,
    sail,
    table,
    write_runs,
)
from swamp_rl.experiments.synthetic.drivers import straight

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.run_set import read_run_set
from swamp_rl.criticism.diagnose import examine
from swamp_rl.criticism.inference.next_trial import Designed
from swamp_rl.criticism.model.trial_limits import trial_limits
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.errors import UserError
from swamp_rl.one_thread import one_thread

AREA, SECONDS = "40x40", 60.0
BOAT = load_boat("swamp")
ZIG_ZAG = "zig-zag, 80 %"


@dataclass(frozen=True)
class Poor:
    """Runs that excite little: straight ahead at one throttle, `before` seconds of which are not recorded.

    effects: what may be wrong; noise: (6,) standard deviations.
    """

    name: str
    effects: tuple[str, ...]
    throttle: float
    runs: int = 3
    seconds: float = 30.0
    before: float = STEADY
    one_course: bool = False
    noise: Array = field(default_factory=lambda: RTK)


KINDS = (
    Poor(
        "steady, 70 %, several courses",
        ("resistance", "thrust_scale", "linear_drag", "advance_thrust_loss"),
        throttle=0.7,
    ),
    Poor(
        "steady, 40 %, two short runs",
        ("thrust_scale", "linear_drag", "resistance", "thrust_deduction"),
        throttle=0.4,
        runs=2,
        seconds=15.0,
    ),
    Poor(
        "from rest, plain GPS, one course",
        ("mass", "thrust_scale", "resistance", "linear_drag"),
        throttle=0.7,
        seconds=20.0,
        before=0.0,
        one_course=True,
        noise=PLAIN,
    ),
)


@dataclass(frozen=True)
class Outcome:
    """Of one case. rivals: explanations of the first diagnosis; after: those of the second; named: causes of
    the second; kept: whether the true boat stayed in the area; ratio: evidence a second of the designed trial
    over that of a zig-zag; separation: expected, in standard errors.
    """

    number: int
    kind: str
    truth: str
    rivals: list[str]
    after: list[str]
    named: list[str]
    kept: bool
    ratio: float
    separation: float
    times_best: float

    @property
    def confounded(self) -> bool:
        """Whether the first diagnosis left more than one explanation."""
        return len(self.rivals) > 1

    @property
    def right(self) -> bool:
        """Whether the second one names the truth alone."""
        return not self.after and self.named == [self.truth]


@one_thread()
def outcome(number: int, folder: Path) -> Outcome:
    """Draw a case, diagnose it, design the next trial, sail that with the true boat, diagnose both."""
    kind = KINDS[number % len(KINDS)]
    rng = np.random.default_rng([11, number])
    effect = kind.effects[number // len(KINDS) % len(kind.effects)]
    size = float(rng.uniform(0.5, 1.5))
    case = Case("A", "single", [{"effect": effect} | EFFECTS[effect](rng, size, "A")], size)
    _write(folder / "first", [_voyage(case, kind, rng) for _ in range(kind.runs)], kind, rng)
    limits = trial_limits(AREA, BOAT, SECONDS)
    try:
        found = examine(read_run_set(folder / "first", BOAT), None, np.random.default_rng(0), limits)
    except UserError:  # nothing to design
        return Outcome(number, kind.name, effect, [], [], [], True, math.nan, math.nan, math.nan)
    assert found.next_trial
    rivals = _sets(found.diagnosis)
    result = found.next_trial.result
    zig_zag = next(one for one in result.of_list if one.manoeuvre == ZIG_ZAG)
    ratio = (result.evidence / result.duration_s) / max(zig_zag.evidence / zig_zag.duration_s, 1e-9)
    voyage = _sailed(case, found.next_trial)
    here = voyage.track[:, :2]
    kept = bool((here >= 0.0).all() and (here <= [limits.north, limits.east]).all())
    after, named = [], list[str]()
    if rivals:
        _write(folder / "next", [voyage], kind, rng)
        both = examine(
            read_run_set([folder / "first", folder / "next"], BOAT), None, np.random.default_rng(0)
        )
        after = _sets(both.diagnosis)
        named = [one.effect for one in both.diagnosis.causes]
    separation = result.separates[0].separation if result.separates else math.nan
    times_best = result.evidence / max(result.of_list[0].evidence, 1e-9)
    return Outcome(number, kind.name, effect, rivals, after, named, kept, ratio, separation, times_best)


def _sets(found: Diagnosis) -> list[str]:
    return found.indistinguishable[0] if found.indistinguishable else []


def _voyage(case: Case, kind: Poor, rng: Rng) -> Voyage:
    heading = 0.5 if kind.one_course else float(rng.uniform(-math.pi, math.pi))
    start = np.array([*rng.uniform(-5, 5, 2), heading])
    steps, before = round(kind.seconds / DT), round(kind.before / DT)
    return sail(BOAT, case, straight(kind.throttle), start, steps, before)


def _sailed(case: Case, trial: Designed) -> Voyage:
    """The designed trial as the true boat sails it."""
    rows = trial.commands
    start = np.array([*trial.result.start_m, 0.0])
    return sail(
        BOAT, case, lambda time, state: rows[min(round(time / DT), len(rows) - 1)], start, len(rows) - 1
    )


def _write(folder: Path, voyages: list[Voyage], kind: Poor, rng: Rng) -> None:
    tables: list[dict[str, Any]] = []
    for voyage in voyages:
        measured, kept = measure(voyage, kind.noise, rng)
        columns: dict[str, Array] = table(BOAT, measured, voyage.commands, kind.noise is not PLAIN)
        tables.append({key: values[kept] for key, values in columns.items()})
    folder.mkdir(parents=True)
    write_runs(folder, "swamp", BOAT, tables, "measured", "csv")
