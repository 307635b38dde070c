"""The next trial: the commands of greatest expected evidence that keep within limits."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.inference.estimate import components, sides_of
from swamp_rl.criticism.inference.sandwich_covariance import covariance_of_data, sandwich_covariance
from swamp_rl.criticism.inference.trial_evidence import (
    Question,
    explanation_of,
    rate,
    refitted,
    refitted_pair,
)
from swamp_rl.criticism.inference.unidentifiable import unidentifiable
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, inverse
from swamp_rl.criticism.model.command_family import CommandFamily, command_family
from swamp_rl.criticism.model.manoeuvres import manoeuvres
from swamp_rl.criticism.model.trial_limits import TrialLimits, shortest_trial, start_in
from swamp_rl.criticism.options import options
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.result import Narrowed, NextTrial, RatedManoeuvre, Separated
from swamp_rl.errors import UserError
from swamp_rl.guidance.flight import command_columns
from swamp_rl.runs import Run, write_run

Array = NDArray[np.float64]

FILE = "next_trial.csv"


@dataclass(frozen=True)
class Designed:
    """The next trial: its `result` in diagnosis.json; commands (T, 2K), a row each sample step; names and
    tracks (H, T, 6) of the true motion under each explanation, places from the area's south-west corner.
    """

    result: NextTrial
    commands: Array
    names: tuple[str, ...]
    tracks: Array


def question_of(
    run_set: RunSet, sigmas: Array, problem: Shooting, winner: Fit, rivals: Sequence[Fit]
) -> tuple[Question, Narrowed | None]:
    """Which of the rivals is true or, without any, the parameter of the winner whose interval is the widest
    in its typical sizes.

    UserError where there are no rivals and no interval.
    """
    if rivals:
        every = tuple(explanation_of(one, one.covariance) for one in (winner, *rivals))
        return Question(run_set, sigmas, every), None
    covariance = sandwich_covariance(problem, winner)
    explanation = explanation_of(winner, covariance)
    deviations = np.sqrt(np.abs(np.diag(inverse(explanation.precision))))
    of_one_run = [(one, own, place) for one, own in winner.parts() for place in range(one.of_one.size)]
    candidates = [
        (deviation / one.specs[place].scale, column)
        for column, ((one, own, place), deviation) in enumerate(zip(of_one_run, deviations, strict=True))
        if not (one.groups or sides_of(one, own)[place] or not math.isfinite(deviation))
    ]
    if not candidates:
        raise UserError(
            "--next: no trial to design: no hypotheses are indistinguishable, and no cause has an interval "
            "that a trial can narrow"
        )
    column = max(candidates, key=lambda one: one[0])[1]
    instance, _, place = of_one_run[column]
    name, unit = components(instance)[place]
    now, mine = float(deviations[column]), winner.hypothesis.columns(instance.label)
    known = not unidentifiable(instance, covariance[np.ix_(mine, mine)])[place]
    narrowed = Narrowed(
        effect=instance.label,
        parameter=name,
        unit=unit,
        before=now,
        after=now,
        scatter=float(_scatter(problem, winner, covariance)[column]),
        identifiable=known,
    )
    return Question(run_set, sigmas, (explanation,), column), narrowed


def _scatter(problem: Shooting, winner: Fit, covariance: Array) -> Array:
    """(p,) variances between runs beyond the noise, in those of a covariance (p, p): what errors of the model
    and of the boat file's numbers add.
    """
    is_weighted = problem.correlation_samples > 1.0  # by the model error
    noise = winner.covariance if is_weighted else covariance_of_data(problem, winner)
    share = np.diag(noise) / np.maximum(np.diag(covariance), 1e-300)
    return len(np.unique(problem.windows.run)) * np.maximum(0.0, 1.0 - np.nan_to_num(share, nan=1.0))


def design_trial(
    question: Question, narrows: Narrowed | None, limits: TrialLimits, rng: np.random.Generator
) -> Designed:
    """The best trial that was found, never worse than the best fixed manoeuvre within the same limits.

    The search begins from the fixed manoeuvres and random sequences of their commands, and replaces blocks of
    commands at random: an evolution strategy (μ + λ), a stochastic form of the exchange
    algorithms of optimal design (Fedorov 1972). A trial ends where a limit is exceeded, and its evidence with
    it. UserError where none is long enough for a diagnosis.
    """
    boat, dt = question.run_set.boat, question.run_set.dt
    family = command_family(boat, dt, limits.seconds, limits.throttle)
    fixed = manoeuvres(boat, dt, limits.seconds, limits.throttle)
    listed = family.begun(np.stack(list(fixed.values())))
    found = _searched(question, family, limits, listed, rng)
    both = np.concatenate([listed, found[None]])
    rated = rate(question, both, limits)
    evidence, _ = refitted(question, both, rated, len(both))
    best = int(_merit(evidence, rated.rows, dt).argmax())
    rows = int(rated.rows[best])
    if rows * dt < shortest_trial():
        raise UserError(
            f"--next: no commands that were tried keep the boat within the limits for "
            f"{shortest_trial():g} s; give a larger area or a greater --top-speed, or leave --next out"
        )
    if evidence[best] < options().least_trial_evidence:
        raise UserError(f"--next: {_undecided(question, narrows)}; widen them, or leave --next out")
    tracks = rated.tracks[:, best, :rows].copy()
    start = start_in(limits, tracks)
    tracks[..., :2] += start
    if narrows:  # random-effects model: DerSimonian and Laird, Controlled Clinical Trials 7, 1986
        added = evidence[best] / (1.0 + narrows.scatter * evidence[best])
        narrows = narrows.model_copy(update={"after": narrows.before / math.sqrt(1.0 + added)})
    every = zip(fixed, evidence, rated.rows, strict=False)  # less the last, which was found
    result = NextTrial(
        file=FILE,
        duration_s=rows * dt,
        hold_s=family.hold * dt,
        area_m=(limits.north, limits.east),
        start_m=(float(start[0]), float(start[1])),
        top_speed=float(np.hypot(tracks[..., 3], tracks[..., 4]).max()),
        evidence=float(evidence[best]),
        separates=_separated(question, both[best, :rows]),
        narrows=narrows,
        of_list=sorted(
            (
                RatedManoeuvre(manoeuvre=name, evidence=float(worth), duration_s=float(count * dt))
                for name, worth, count in every
            ),
            key=lambda one: one.evidence,
            reverse=True,
        ),
    )
    return Designed(result, both[best, :rows], tuple(one.label for one in question.explanations), tracks)


def _undecided(question: Question, narrows: Narrowed | None) -> str:
    """What no commands that keep the limits decide."""
    if narrows is None:
        names = " and ".join(dict.fromkeys(one.label for one in question.explanations))
        return f"no commands that were tried within the limits separate {names}"
    parameter = f"{narrows.parameter} of {narrows.effect}"
    unit = f" {narrows.unit}" if narrows.unit != "1" else ""
    return (
        f"no commands that were tried within the limits narrow the interval of {parameter}, whose standard "
        f"error is {narrows.before:.2g}{unit}"
    )


def write_trial(folder: Path, trial: Designed, boat: Boat, dt: float) -> None:
    """Write the commands, with the motion that the first explanation predicts, a row each dt [s]."""
    motion = dict(zip(CHANNELS, trial.tracks[0].T, strict=True))
    motion["heading"] = wrapped(motion["heading"])
    columns = {"time": dt * np.arange(len(trial.commands))} | motion | command_columns(boat, trial.commands)
    write_run(folder / FILE, Run(Path(FILE).stem, columns))


def _searched(
    question: Question, family: CommandFamily, limits: TrialLimits, listed: Array, rng: np.random.Generator
) -> Array:
    """(T, 2K) the best commands of the family that were found."""
    tried = np.concatenate([family.sampled(listed), family.random(rng, options().trial_random)])
    kept, merit, dt = tried[:0], np.zeros(0), question.run_set.dt
    used, quiet, best = 0, 0, 0.0
    while used < options().trial_budget and quiet < options().trial_patience:
        commands = family.rows(tried)
        rated = rate(question, commands, limits)
        evidence, steps = refitted(question, commands, rated, options().trial_parents, merit.tolist())
        used += rated.steps + steps
        kept = np.concatenate([kept, tried])
        merit = np.concatenate([merit, _merit(evidence, rated.rows, dt)])
        order = np.argsort(-merit, kind="stable")[: options().trial_parents]
        kept, merit = kept[order], merit[order]
        quiet = 0 if merit[0] > (1.0 + options().trial_worth) * best else quiet + 1
        best = max(best, float(merit[0]))
        LOG.debug("next trial: evidence %.4g after %d boat steps", best, used)
        tried = np.stack(
            [family.exchanged(kept[n % len(kept)], rng) for n in range(options().trial_children)]
        )
    return family.rows(kept[:1])[0]


def _merit(evidence: Array, rows: NDArray[np.int64], dt: float) -> Array:
    """(W,) evidence of trials of so many rows, below zero where one ends too early."""
    return np.where(rows * dt >= shortest_trial(), evidence, -1.0 / np.maximum(rows, 1))


def _separated(question: Question, commands: Array) -> list[Separated]:
    """Each pair of explanations under commands (T, 2K), the least separated first."""
    names, found = [one.label for one in question.explanations], list[Separated]()
    for a, b in combinations(range(len(names)), 2):
        evidence = min(refitted_pair(question, commands, *pair)[0] for pair in ((a, b), (b, a)))
        found.append(Separated(effects=[names[a], names[b]], separation=math.sqrt(evidence)))
    return sorted(found, key=lambda one: one.separation)
