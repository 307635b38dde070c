"""Diagnosis of a boat file from measured runs: causes, their parameters, and the gain of adding them."""

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import load_boat
from swamp_rl.counted import counted
from swamp_rl.criticism.data.checks import refuse_sources_inside
from swamp_rl.criticism.data.command_names import as_column
from swamp_rl.criticism.data.excitation import missing_motion
from swamp_rl.criticism.data.inputs import Named, inputs_of, read_inputs
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.inference.boat_errors import beside_boat_errors
from swamp_rl.criticism.inference.cause_share import (
    CauseList,
    Witness,
    in_its_weather,
    list_causes,
    without_equal_rivals,
    witnesses,
    written_fit,
)
from swamp_rl.criticism.inference.estimate import causes_of, correlation
from swamp_rl.criticism.inference.finding import Finding
from swamp_rl.criticism.inference.force_extension import extend_by_force
from swamp_rl.criticism.inference.force_regression import (
    residual_force_functions,
    without_process_noise,
)
from swamp_rl.criticism.inference.identifiability import contrast, hidden_effects, separating_manoeuvre
from swamp_rl.criticism.inference.next_steps import next_steps
from swamp_rl.criticism.inference.next_trial import Designed, design_trial, question_of, write_trial
from swamp_rl.criticism.inference.self_trial import TWINS, Each, Method, self_trial, serially
from swamp_rl.criticism.inference.special_cases import with_sufficient_special_cases
from swamp_rl.criticism.inference.unidentifiable import with_neutral_values
from swamp_rl.criticism.likelihood.adequacy import adequacy
from swamp_rl.criticism.likelihood.cross_validation import bootstrap_interval, heldout_loss
from swamp_rl.criticism.likelihood.gauss_markov import WHITE
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import Fit, fit
from swamp_rl.criticism.likelihood.prediction_error import gains, no_better, trivial_predictors
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.extended_boat import write_extended
from swamp_rl.criticism.model.trial_limits import TrialLimits
from swamp_rl.criticism.nuisance.process_noise import in_noise_units
from swamp_rl.criticism.options import options
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.result import (
    Candidate,
    Contrast,
    Diagnosis,
    GaussMarkovNoise,
    ResidualForce,
    Verdict,
)
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.continuation import MIDDLE, Continuation
from swamp_rl.criticism.selection.model_selection import select_model
from swamp_rl.criticism.selection.preparation import prepared
from swamp_rl.errors import UserError
from swamp_rl.files import written_path
from swamp_rl.one_thread import one_thread
from swamp_rl.unfinished import folder_beside

Array = NDArray[np.float64]

RESULT = "diagnosis.json"


@one_thread()
def diagnose(
    dataset: Named | Sequence[Named],
    boat: str | Path | None,
    out: Path | str,
    holdout: Named | None = None,
    seed: int = 0,
    ignore: Sequence[str] = (),
    twins: int = TWINS,
    method: Method = "linearised",
    each: Each = serially,
    limits: TrialLimits | None = None,
    notes: Mapping[str, str] = MappingProxyType({}),
) -> Diagnosis:
    """Diagnose a boat file against one or several folders of runs; write the results into the folder `out`.

    Written are diagnosis.json, extended_boat.yaml, report.html and, if weather was identified,
    conditions.yaml.

    - `dataset`, `holdout`: datasets or their folders. The gain is measured on `holdout`; without it, on each
      run in turn (leave-one-run-out).
    - `boat`: name or file; None for that of the (first) dataset.
    - `ignore`: measured quantities that are not used (`wind`, `depth`).
    - `twins`, `method`, `each`: settings of the self-trial; none with 0 twins.
    - `limits`: limits of the next trial. If given, it is designed and written as next_trial.csv, provided
      that there are explanations to separate or an interval to narrow.
    - `notes`: texts of additional files in the folder, by file name.

    UserError if the data do not allow a diagnosis.
    """
    inputs, out = inputs_of(dataset, boat, holdout), written_path(out)
    LOG.info("reading %s", inputs.label)
    model = load_boat(inputs.boat)
    sources = [*inputs.folders, *([inputs.holdout] if inputs.holdout else []), Path(inputs.boat)]
    refuse_sources_inside(out, [one for one in sources if one.exists()])
    run_set, other = read_inputs(inputs, model, ignore)
    from swamp_rl.criticism.report import write_report

    with folder_beside(out, RESULT) as folder:
        finding = examine(run_set, other, np.random.default_rng(seed), limits)
        if twins:
            began = time.perf_counter()
            finding.diagnosis.self_trial = self_trial(run_set, finding, twins, method, seed, each)
            finding.diagnosis.elapsed_s += time.perf_counter() - began
        write_extended(
            folder, inputs.boat, *finding.written_effects, finding.run_set.names, finding.written_curves
        )
        if finding.next_trial:
            write_trial(folder, finding.next_trial, model, run_set.dt)
        LOG.info("drawing the report")
        write_report(folder, finding, ", ".join("/".join(one.resolve().parts[-2:]) for one in inputs.folders))
        for name, text in {**notes, RESULT: finding.diagnosis.model_dump_json(indent=2) + "\n"}.items():
            (folder / name).write_text(text, encoding="utf-8")
    return finding.diagnosis


@np.errstate(over="ignore", invalid="ignore")  # where a hypothesis makes the boat diverge
def examine(
    run_set: RunSet, other: RunSet | None, rng: np.random.Generator, limits: TrialLimits | None = None
) -> Finding:
    """The diagnosis of runs in memory; `other`: runs to measure the gain on; limits: of the next trial."""
    began = time.perf_counter()
    minutes = run_set.lengths.sum() * run_set.dt / 60
    LOG.info("%s, %.1f min: noise and candidates", counted(len(run_set.lengths), "run"), minutes)
    known = prepared(run_set)
    sigmas, weight, every, hull = known.sigmas, known.weight, known.instances, known.hull
    behind = no_better(trivial_predictors(run_set, weight))
    if behind:
        LOG.info("the boat file predicts %s; if its numbers are guesses, fit them first", behind.words)
    with_noise, continuation, found = select_model(run_set, weight, every, hull)
    run_set = run_set.with_commands_of(with_noise)
    LOG.info("the best hypothesis is %s; adequacy", found.winner.hypothesis.label)
    on = Witness(run_set, weight, others=False)
    if other is not None:
        on = Witness(other, weights(other, noise_levels(other)), others=True)
    noise = {n: float(s) for n, s in zip(CHANNELS, sigmas, strict=True) if np.isfinite(s)}
    found = with_sufficient_special_cases(continuation, found, every, on, noise, rng)
    found = with_neutral_values(continuation, found)
    found, within = _beside_boat_errors(continuation, weight, found)
    judged = continuation.problem(found.stage, found.winner.hypothesis)
    measure = adequacy(judged, in_noise_units(found.winner, judged, weight))

    LOG.info("confirmation on held-out runs, prediction errors")
    on = in_its_weather(on, continuation, found.winner, found.stage)
    where = witnesses(on, rng)
    written, shares, left_out = written_fit(continuation, found.winner, found.stage, where, rng)
    listed = list_causes(judged, found, shares, left_out, noise, within)
    found = found if listed.sound else replace(found, adequate=False)
    found = without_equal_rivals(continuation, found, listed, where, noise, rng)

    extension = None
    leftover = list[ResidualForce]()
    if not found.adequate:
        rest = replace(run_set, gauss_markov=with_noise.gauss_markov)
        models = [(Hypothesis(), np.zeros(0)), (found.winner.hypothesis, found.winner.x)]
        own = found.winner.hypothesis.instances
        leftover = residual_force_functions(rest, weight, models if own else models[:1])
        extension = extend_by_force(without_process_noise(rest), weight, written, leftover, on, rng)
    predicting = continuation.problem(found.stage, written.hypothesis), written
    if extension and extension.result.written:
        predicting = extension.problem, extension.fit

    hidden = hidden_effects(run_set, weight, judged, found, [*every, *([hull] if hull else [])])

    names = [one.hypothesis.cause_label for one in (found.winner, *found.rivals)]
    seen = {one.label for fit in (found.winner, *found.rivals) for one in fit.hypothesis.instances}

    def rival(one: Fit) -> Contrast:
        apart = continuation.criterion(one) - continuation.criterion(found.winner)
        causes = causes_of(continuation.problem(found.stage, one.hypothesis), one)
        return contrast(judged, found.winner, one, apart, causes)

    verdict, lacks = verdict_of(found, listed), missing_motion(run_set, other is not None)
    extended = extension.result if extension else None
    diagnosis = Diagnosis(
        verdict=verdict,
        predictors=trivial_predictors(on.run_set, on.weight),
        causes=listed.causes,
        minor=listed.minor,
        nuisance=listed.nuisance,
        correlation=correlation(judged, found.winner, [*listed.causes, *listed.nuisance]),
        indistinguishable=[names] if found.rivals else [],
        contrasts=[rival(one) for one in found.rivals],
        separating_trial=separating_manoeuvre(with_noise, sigmas, found.winner, found.rivals),
        leftover=[
            one.model_copy(update={"variable": as_column(one.variable, run_set.boat)}) for one in leftover
        ],
        extension=extended,
        next_steps=next_steps(run_set.boat, leftover, extended, lacks, run_set.wind)
        if verdict == "unexplained"
        else [],
        candidates=_candidates(continuation, found, rng),
        hypotheses=sum(bool(one.hypothesis.instances) for one in found.tried),
        discrete=labels_without_number(one.hypothesis for one in found.tried),
        unseen=[label for label in found.unidentifiable if label not in seen.union(hidden)],
        hidden=hidden,
        missing_motion=lacks,
        gain=gains(on.run_set, on.weight, *on.numbers(*predicting), rng),
        gain_on="other_runs" if other else "same_run" if len(run_set.lengths) == 1 else "each_run_in_turn",
        noise=noise | _white_beside(with_noise, noise),
        wandering=_gauss_markov_noise(with_noise),
        smoothed=known.smoothed,
        adequacy={"worst_excess": measure.worst, "channel": measure.channel, "adequate": found.adequate},
        elapsed_s=time.perf_counter() - began,
    )
    trial = _next_trial(with_noise, sigmas, judged, found, limits, rng) if limits else None
    diagnosis.next_trial = trial.result if trial else None
    return Finding(diagnosis, run_set, weight, continuation, found, written, extension, trial)


def _next_trial(
    run_set: RunSet,
    sigmas: Array,
    judged: Shooting,
    found: Selection,
    limits: TrialLimits,
    rng: np.random.Generator,
) -> Designed | None:
    """The trial that separates or narrows most; None, with a log of the reason, where there is none."""
    LOG.info("designing the next trial")
    try:
        return design_trial(*question_of(run_set, sigmas, judged, found.winner, found.rivals), limits, rng)
    except UserError as error:  # the diagnosis took minutes and stands without the trial
        LOG.info("%s", error)
        return None


def _beside_boat_errors(
    continuation: Continuation, weight: Array, found: Selection
) -> tuple[Selection, frozenset[str]]:
    """The selection if the boat file's numbers may be off by their errors, and the labels of the winner's
    effects that these allow; as it is where the file has no `covariance`.

    It is adequate then if what these leave is noise; a rival that differs by such effects alone is none.
    """
    if continuation.run_set.boat.covariance is None:
        return found, frozenset()
    problem = Shooting(continuation.run_set, weight, continuation.problems[MIDDLE].seconds)
    kept, known = list[Fit](), list[set[str]]()
    for one in (found.winner, *found.rivals):
        at = fit(problem, one.hypothesis, one.x, problem.initial_states(), fresh=True)
        beside = beside_boat_errors(problem, at, continuation.criterion.required_gain)
        beyond = {instance.label for instance in one.hypothesis.instances} - beside.within
        if not kept:
            within, adequate = beside.within, found.adequate or beside.adequate
        if beyond not in known:
            kept, known = [*kept, one], [*known, beyond]
    return replace(found, rivals=kept[1:], adequate=adequate), within


def verdict_of(found: Selection, listed: CauseList) -> Verdict:
    """The verdict on a selection; minor causes have no part in it."""
    if not found.adequate:
        return "unexplained"
    if found.winner.hypothesis.instances and not listed.causes:
        return "nothing_wrong"
    if not found.winner.hypothesis.instances and not found.rivals:
        return "nothing_wrong"
    return "indistinguishable" if found.rivals else "cause"


def _gauss_markov_noise(run_set: RunSet) -> dict[str, GaussMarkovNoise]:
    """Of each channel with a Gauss-Markov part."""
    if run_set.gauss_markov is None:
        return {}
    return {
        name: GaussMarkovNoise(standard_deviation=float(size), time_constant_s=float(seconds))
        for name, (size, seconds, _) in zip(CHANNELS, run_set.gauss_markov, strict=True)
        if size > 0
    }


def _white_beside(run_set: RunSet, noise: Mapping[str, float]) -> dict[str, float]:
    """The white part of each channel's noise, which is less beside a Gauss-Markov part."""
    if run_set.gauss_markov is None:
        return {}
    return {
        name: noise[name] * float(white)
        for name, white in zip(CHANNELS, run_set.gauss_markov[:, WHITE], strict=True)
        if name in noise
    }


def _candidates(continuation: Continuation, found: Selection, rng: np.random.Generator) -> list[Candidate]:
    problem, nothing = continuation.problems[0], continuation.boat_file(0)
    samples = problem.samples / problem.correlation_samples  # that are independent
    listed = []
    for one in [nothing, *(one for one in found.tried if one.hypothesis.instances)]:
        loss = heldout_loss(problem, one)
        gains = nothing.loss - loss
        interval = bootstrap_interval(gains, 1.0 - 2.0 * options().tail, rng)
        score, gain = float(loss.sum()) / samples, float(gains.sum())
        listed.append(
            Candidate(effect=one.hypothesis.label, held_out_score=score, gain=gain, gain_ci=interval)
        )
    return sorted(listed, key=lambda one: one.held_out_score)[: options().listed]


def labels_without_number(hypotheses: Iterable[Hypothesis]) -> list[str]:
    """Of those hypotheses whose effects have no number, as a swap of channels."""
    return [one.label for one in hypotheses if one.instances and not one.size]
