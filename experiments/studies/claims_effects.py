"""The claims of thesis 7.3.3 as numbers: one for each training and episode, and a bound to be exceeded."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.config.claims import Claims

from swamp_rl.boat import Boat
from swamp_rl.evaluation import Rollout, Table, command_change, jet_power
from swamp_rl.evaluation.metrics import bollard_thrust, jet_areas
from swamp_rl.evaluation.tracks import distances, mean_other, nearest_of_fewer, nearest_other, outside
from swamp_rl.runs import Run

Array = NDArray[np.float64]
Flight = tuple[Table, Rollout]
Who = tuple[str, str]
"""Pilot and level of evaluation."""

CLAIMS = {
    "few": "A few runs suffice",
    "copy": "The pilot does not copy a track",
    "elsewhere": "It succeeds from starts outside the training tracks, reversed heading included",
    "disturbed": "It withstands gusts, current and stern-thruster kicks",
    "smoother": "Its commands are smoother and use less power than the demonstrator's",
}
"""The claims of the thesis, which are about the levels that `Claims` has by default."""
OF_LEVELS = {
    "elsewhere": "It succeeds from starts outside the training tracks",
    "disturbed": "It withstands disturbances",
}
"""The same of other levels, which are named beside."""


@dataclass(frozen=True)
class Hypothesis:
    """That the mean of `values` is above `bound`.

    values: (S, E) of S trainings in E episodes, NaN where there is nothing to count. shown: how a value is
    written, `rate`, `points`, `ratio` or `saving`. reference: the same of the data's own pilot, where it was
    tried too. decides: whether the claim's verdict hangs on it.
    """

    claim: str
    text: str
    values: Array
    bound: float
    shown: str
    reference: float | None = None
    decides: bool = True


@dataclass(frozen=True)
class Flown:
    """All that was tried: by pilot and level, each of the S trainings; what each learned from; who taught."""

    trained: Mapping[Who, Sequence[Flight]]
    lessons: Sequence[Sequence[Run]]
    teacher: Mapping[str, Flight] | None
    "The scripted pilot by level, where the data are its runs."
    boat: Boat

    def success(self, who: str, level: str) -> Array:
        """(S, E), 1 where it arrived."""
        return np.array([table["success"] for table, _ in self.trained[who, level]], dtype=float)

    def teachers_success(self, level: str) -> float | None:
        """The data's own pilot's success rate."""
        return None if self.teacher is None else float(self.teacher[level][0]["success"].mean())


def title(claim: str, plan: Claims) -> str:
    """A claim in words: the thesis's where its levels are those of the thesis."""
    if claim not in OF_LEVELS:
        return CLAIMS[claim]
    levels = getattr(plan, claim)
    as_there = set(levels) == set(getattr(Claims(pilot=plan.pilot), claim))
    return CLAIMS[claim] if as_there else f"{OF_LEVELS[claim]}: {', '.join(levels)}"


def count(plan: Claims) -> int:
    """How many hypotheses `hypotheses` makes."""
    few = 2 * len(plan.runs) - 1
    copy, elsewhere, smooth = 2, 2 * len(plan.elsewhere), 2
    return few + copy + elsewhere + len(plan.disturbed) + smooth


def named(runs: int) -> str:
    """The pilot that learned from so many runs."""
    return f"{runs} runs"


def alone(runs: int) -> str:
    """As `named`, without a takeover."""
    return f"{runs} runs, alone"


def hypotheses(plan: Claims, flown: Flown) -> list[Hypothesis]:
    """All of them, in the order of CLAIMS."""
    parts = (few_suffice, not_copied, from_elsewhere, stands, smoother)
    return [one for part in parts for one in part(plan, flown)]


def few_suffice(plan: Claims, flown: Flown) -> list[Hypothesis]:
    """Success with each number of runs, and what is lost against the highest."""
    made, most = [], max(plan.runs)
    best = flown.success(named(most), plan.at)
    teacher = flown.teachers_success(plan.at)
    for runs in sorted(plan.runs):
        own, decides = flown.success(named(runs), plan.at), runs == plan.few
        text = f"{runs} runs: success at `{plan.at}` is above {100 * plan.least.success:g} %"
        made.append(Hypothesis("few", text, own, plan.least.success, "rate", teacher, decides))
        if runs < most:
            loss = f"{100 * plan.least.loss:g} points below that of {most} runs"
            text = f"{runs} runs: success is less than {loss}"
            made.append(Hypothesis("few", text, own - best, -plan.least.loss, "points", None, decides))
    return made


def not_copied(plan: Claims, flown: Flown) -> list[Hypothesis]:
    """Logarithms of how far its successful tracks lie from the nearest run of the data, and from each other.

    Against the same among the runs of the data. A run that goes round for another try lies far from all
    others; in a mean of distances themselves a few of those would drown the rest.
    """
    near, spread, own = [], [], []
    for (table, rollout), lesson in zip(flown.trained[named(plan.few), plan.at], flown.lessons, strict=True):
        runs = [run.pose for run in lesson[: plan.few]]
        among = distances(runs, runs)
        scale = _middle(nearest_other(among))
        won = np.flatnonzero(table["success"])
        tracks = [rollout.track(int(i)) for i in won]
        closest = np.log(nearest_of_fewer(distances(tracks, runs))) - scale
        near.append(_at(won, len(table["seed"]), closest))
        others = np.log(mean_other(distances(tracks, tracks))) - _middle(mean_other(among))
        spread.append(_at(won, len(table["seed"]), others))
        if flown.teacher is not None:
            driven, drive = flown.teacher[plan.at]
            theirs = [drive.track(int(i)) for i in np.flatnonzero(driven["success"])]
            own.append(_middle(nearest_of_fewer(distances(theirs, runs))) - scale)
    least, share = float(np.log(plan.least.novelty)), f"{plan.least.novelty:g} times"
    nearest = f"distance of its tracks from the nearest run of the data is above {share} that among the runs"
    apart = f"mean distance between its tracks is above {share} that between the runs"
    teacher = float(np.mean(own)) if own else None
    return [
        Hypothesis("copy", nearest, np.array(near), least, "ratio", teacher),
        Hypothesis("copy", apart, np.array(spread), least, "ratio"),
    ]


def from_elsewhere(plan: Claims, flown: Flown) -> list[Hypothesis]:
    """Success from starts outside the convex hull of all tracks that it learned from.

    As at Camogli somebody may drive the first seconds; without that the claim is not the thesis's.
    """
    made = []
    for level in plan.elsewhere:
        first = ((named(plan.few), "", True), (alone(plan.few), ", without a takeover", False))
        for who, words, decides in first:
            values = []
            for (table, rollout), lesson in zip(flown.trained[who, level], flown.lessons, strict=True):
                off = outside(rollout.pose[:, 0, :2], [run.pose for run in lesson[: plan.few]])
                values.append(np.where(off, table["success"].astype(float), np.nan))
            bound = plan.least.success_elsewhere
            text = f"`{level}`{words}: success is above {100 * bound:g} %"
            rate = flown.teachers_success(level)
            made.append(Hypothesis("elsewhere", text, np.array(values), bound, "rate", rate, decides))
    return made


def stands(plan: Claims, flown: Flown) -> list[Hypothesis]:
    """Success among disturbances less that without, in the same episodes."""
    made, teacher = [], flown.teachers_success(plan.calm)
    still = flown.success(named(plan.few), plan.calm)
    for level in plan.disturbed:
        text = f"`{level}`: success is less than {100 * plan.least.loss:g} points below `{plan.calm}`"
        lost = flown.success(named(plan.few), level) - still
        theirs = flown.teachers_success(level)
        reference = None if theirs is None or teacher is None else theirs - teacher
        made.append(Hypothesis("disturbed", text, lost, -plan.least.loss, "points", reference))
    return made


def smoother(plan: Claims, flown: Flown) -> list[Hypothesis]:
    """Logarithms of its pilot's change of command and mean power over its own, where it arrived.

    Paired with the data's pilot in the same episodes where that can be tried; else against the means of the
    runs that it learned from.
    """
    change: list[Array] = []
    power: list[Array] = []
    for (table, _), lesson in zip(flown.trained[named(plan.few), plan.at], flown.lessons, strict=True):
        theirs = _teachers(flown, plan, lesson)
        with np.errstate(divide="ignore", invalid="ignore"):
            both = table["success"] & theirs["success"]
            for kept, own, other in (
                (change, table["command_change"], theirs["command_change"]),
                (power, table["energy"] / table["time"], theirs["power"]),
            ):
                kept.append(np.where(both, np.log(other / own), np.nan))
    bound, share = -np.log1p(-plan.least.saving), f"{100 * plan.least.saving:g} %"
    texts = (
        f"command change per step is at least {share} below the demonstrator's",
        f"power of the wake is at least {share} below the demonstrator's",
    )
    return [
        Hypothesis("smoother", text, np.array(values), float(bound), "saving")
        for text, values in zip(texts, (change, power), strict=True)
    ]


def _teachers(flown: Flown, plan: Claims, lesson: Sequence[Run]) -> dict[str, Any]:
    if flown.teacher is not None:
        table, _ = flown.teacher[plan.at]
        return {**table, "power": table["energy"] / table["time"]}
    runs = lesson[: plan.few]
    return {
        "success": True,
        "command_change": np.mean([command_change(run.joypad) for run in runs]),
        "power": np.mean([lever_power(run, flown.boat) for run in runs]),
    }


def lever_power(run: Run, boat: Boat) -> float:
    """Mean power [W] of the jets that the throttle lever drives, from the lever alone; see `jet_power`."""
    driven = [item for item in boat.thrusters if item.name in boat.joypad.thrusters]
    idle, full = boat.joypad.throttle
    shares = idle + (full - idle) * np.clip(run.joypad[:, :1], 0.0, 1.0)
    throttle = shares * np.array([item.throttle_max for item in driven])
    linear, quadratic = np.array([item.thrust_curve(boat.water_density) for item in driven]).T
    thrust = bollard_thrust(throttle, linear, quadratic)
    return float(jet_power(thrust, boat.water_density, jet_areas(boat, driven)).sum(axis=1).mean())


def _middle(values: Array) -> float:
    """Mean of logarithms."""
    return float(np.log(values).mean())


def _at(places: NDArray[np.intp], n: int, values: Array) -> Array:
    """(n,) with `values` at `places` and NaN elsewhere."""
    spread = np.full(n, np.nan)
    spread[places] = values
    return spread
