"""From measured runs and a boat file to a diagnosis: what is wrong, by how much, and what it gains to
add it.
"""

import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import load_boat
from swamp_rl.criticism.adequacy import adequacy
from swamp_rl.criticism.candidates import NUISANCE, Hypothesis, candidates, hull_nuisance
from swamp_rl.criticism.colour import searched
from swamp_rl.criticism.conclude import Search
from swamp_rl.criticism.consistency import refuse_inconsistent
from swamp_rl.criticism.correlation import correlation
from swamp_rl.criticism.cost import score
from swamp_rl.criticism.data import CHANNELS, Trials, read_trials
from swamp_rl.criticism.estimate import causes_of
from swamp_rl.criticism.extend import write_extended
from swamp_rl.criticism.finding import Finding
from swamp_rl.criticism.fit import Fit
from swamp_rl.criticism.gain import gains
from swamp_rl.criticism.heldout import bootstrap_interval, heldout_loss, heldout_numbers
from swamp_rl.criticism.imperfect import in_noise
from swamp_rl.criticism.ladder import Ladder
from swamp_rl.criticism.leftover import missing_forces
from swamp_rl.criticism.motion import missing_motion
from swamp_rl.criticism.noise import noise_levels, weights
from swamp_rl.criticism.pointing import leftovers
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.refusals import refuse_other_vehicle, refuse_sources_inside
from swamp_rl.criticism.result import Candidate, Cause, Diagnosis, Gain, HeldOut, Verdict, Wandering
from swamp_rl.criticism.rivals import contrast, separating_trial
from swamp_rl.criticism.shooting import Shooting
from swamp_rl.unfinished import folder_beside

Array = NDArray[np.float64]

RESULT = "diagnosis.json"
NONE = np.zeros(0)
LISTED = 20  # candidates in the report


def diagnose(
    dataset: Path | str, boat: str | Path, out: Path | str, holdout: Path | str | None = None, seed: int = 0
) -> Diagnosis:
    """Diagnose a folder of runs against a boat file; writes diagnosis.json and extended_boat.yaml into `out`.

    holdout: a folder of runs that the gain is measured on, the runs themselves held out in turn where there
    is none. UserError for data that cannot carry a diagnosis.
    """
    dataset, out, holdout = Path(dataset), Path(out), Path(holdout) if holdout is not None else None
    LOG.info("reading %s", dataset)
    model = load_boat(boat)
    refuse_sources_inside(out, [Path(one) for one in (dataset, holdout, boat) if one and Path(one).exists()])
    trials = read_trials(dataset, model, boat)
    refuse_inconsistent(trials, str(dataset))
    other = read_trials(holdout, model, boat) if holdout else None
    if other is not None and holdout is not None:
        refuse_other_vehicle(dataset, holdout)
        refuse_inconsistent(other, str(holdout))
    from swamp_rl.criticism.report import write_report

    with folder_beside(out, RESULT) as folder:
        finding = examine(trials, other, np.random.default_rng(seed))
        winner = finding.search.winner
        write_extended(folder / "extended_boat.yaml", boat, winner.hypothesis, winner.x)
        LOG.info("drawing the report")
        write_report(folder, finding)
        (folder / RESULT).write_text(finding.diagnosis.model_dump_json(indent=2) + "\n", encoding="utf-8")
    return finding.diagnosis


@np.errstate(over="ignore", invalid="ignore")  # of a hypothesis under which the boat diverges
def examine(trials: Trials, other: Trials | None, rng: np.random.Generator) -> Finding:
    """The diagnosis of trials in memory; `other`: trials to measure the gain on."""
    began = time.perf_counter()
    LOG.info(
        "%d runs, %.1f min: noise and candidates", len(trials.lengths), trials.lengths.sum() * trials.dt / 60
    )
    sigmas = noise_levels(trials)
    weight = weights(trials, sigmas)
    duration = float(trials.lengths.max() * trials.dt)
    coloured, ladder, found = searched(trials, weight, candidates(trials.boat, duration), hull_nuisance())
    trials = replace(trials, commands=coloured.commands)  # as the boat obeyed them
    LOG.info("the best hypothesis is %s; adequacy and missing forces", found.winner.hypothesis.label)
    judged = ladder.problems[found.rung]
    measure = adequacy(judged, in_noise(found.winner, judged, weight))
    forces = missing_forces(trials, weight, found.winner.hypothesis, found.winner.x)

    LOG.info("confirmation on held-out runs, prediction errors")
    every, sound = confirmed_causes(ladder.problems[found.rung], found)
    found = found if sound else replace(found, adequate=False)
    alone = all(cause.effect == NUISANCE for cause in every)
    causes = [cause for cause in every if (cause.effect == NUISANCE) == alone]
    nuisance = [cause for cause in every if cause.effect == NUISANCE and not alone]

    def apart(rival: Fit) -> float:
        return score(rival) - score(found.winner)

    diagnosis = Diagnosis(
        verdict=verdict_of(found),
        causes=causes,
        nuisance=nuisance,
        correlation=correlation(ladder.problems[found.rung], found.winner, [*causes, *nuisance]),
        indistinguishable=_sets(found),
        contrasts=[
            contrast(judged, found.winner, one, apart(one)).model_copy(
                update={"rival": causes_of(judged, one)}
            )
            for one in found.rivals
        ],
        separating_trial=separating_trial(coloured, sigmas, found.winner, found.rivals)
        if found.rivals
        else None,
        leftover=[]
        if found.adequate
        else leftovers(replace(trials, slow=coloured.slow), weight, _models(found.winner)),
        candidates=_candidates(ladder, found, rng),
        unseen=found.unseen,
        missing_motion=missing_motion(trials, other is not None),
        gain=_gains(trials, weight, other, ladder, found, rng),
        gain_on="other_runs" if other else "same_run" if len(trials.lengths) == 1 else "each_run_in_turn",
        noise={n: float(s) for n, s in zip(CHANNELS, sigmas, strict=True) if np.isfinite(s)},
        wandering=_wandering(coloured),
        adequacy={"worst_excess": measure.worst, "channel": measure.channel, "adequate": found.adequate},
        elapsed_s=time.perf_counter() - began,
    )
    return Finding(diagnosis, trials, weight, ladder, found, forces)


def confirmed_causes(problem: Shooting, found: Search) -> tuple[list[Cause], bool]:
    """Every atom of the winner as a cause, with what it saves on runs held out; and whether all can be
    claimed: one whose numbers or standard errors are not finite cannot.
    """
    every = causes_of(problem, found.winner)
    for atom, cause in zip(found.winner.hypothesis.atoms, every, strict=True):
        if atom.label in found.confirmed:
            one = found.confirmed[atom.label]
            cause.held_out = HeldOut(gain=one.gain, low=one.low, level=one.level)
    claimed = [cause for cause in every if _is_finite(cause)]
    return claimed, len(claimed) == len(every)


def _models(winner: Fit) -> list[tuple[Hypothesis, Array]]:
    """The boat file alone, and with what was found."""
    found = [(winner.hypothesis, winner.x)] if winner.hypothesis.atoms else []
    return [(Hypothesis(), NONE), *found]


def _is_finite(cause: Cause) -> bool:
    return all(math.isfinite(p.value + p.standard_error) for p in cause.parameters.values())


def verdict_of(found: Search) -> Verdict:
    """One of four."""
    if not found.adequate:
        return "unexplained"
    if not found.winner.hypothesis.atoms and not found.rivals:
        return "nothing_wrong"
    return "indistinguishable" if found.rivals else "cause"


def _wandering(trials: Trials) -> dict[str, Wandering]:
    """Of each channel whose errors wander."""
    if trials.slow is None:
        return {}
    return {
        name: Wandering(standard_deviation=float(size), time_constant_s=float(seconds))
        for name, (size, seconds) in zip(CHANNELS, trials.slow, strict=True)
        if size > 0
    }


def names_of(hypothesis: Hypothesis) -> str:
    """Effects of a hypothesis, joined by plus signs."""
    return " + ".join(atom.effect.name for atom in hypothesis.atoms) or "nothing"


def _sets(found: Search) -> list[list[str]]:
    if not found.rivals:
        return []
    return [[one.hypothesis.accused for one in (found.winner, *found.rivals)]]


def _candidates(ladder: Ladder, found: Search, rng: np.random.Generator) -> list[Candidate]:
    problem = ladder.problems[0]
    nothing = ladder.fit(0, Hypothesis(), np.zeros(0))
    fits: list[Fit] = [nothing, *found.tried]
    listed = []
    for one in fits:
        loss = heldout_loss(problem, one)
        gains = nothing.loss - loss
        low, high = bootstrap_interval(gains, 0.95, rng)
        per_sample = float(loss.sum()) / problem.samples
        listed.append(
            Candidate(
                effect=one.hypothesis.label,
                held_out_score=per_sample,
                gain=float(gains.sum()),
                gain_ci=(low, high),
            )
        )
    return sorted(listed, key=lambda one: one.held_out_score)[:LISTED]


def _gains(
    trials: Trials,
    weight: Array,
    other: Trials | None,
    ladder: Ladder,
    found: Search,
    rng: np.random.Generator,
) -> list[Gain]:
    winner = found.winner
    if other is None:
        numbers = heldout_numbers(ladder.problems[found.rung], winner)
        judged, its_weight = trials, weight
    else:
        judged, its_weight = other, weights(other, noise_levels(other))
        numbers = np.repeat(winner.x[None], len(other.lengths), axis=0)
    return gains(judged, its_weight, winner.hypothesis, numbers, rng)
