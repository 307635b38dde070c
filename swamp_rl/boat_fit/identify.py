"""Identification of a boat file from a folder of runs."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat_fit.boat_file import Fitted, identified_mapping
from swamp_rl.boat_fit.diverging import diverging, implausible_fit
from swamp_rl.boat_fit.fit import SHORT, BoatFit, long_fit, short_fit, window_length
from swamp_rl.boat_fit.hypothesis import WEATHER_SD, FreeBoat, free_boat
from swamp_rl.boat_fit.pieces import Split, split
from swamp_rl.boat_fit.recent_thrust import chosen_gains, recent_errors
from swamp_rl.boat_fit.report import page_of
from swamp_rl.boat_fit.result import Identification
from swamp_rl.boat_fit.run_flow import errors_in_current, is_significant, run_flows
from swamp_rl.boat_fit.run_thrust import (
    FEWEST,
    RunThrust,
    ThrustLevel,
    UnlikeRuns,
    at_level,
    run_thrusts,
    thrust_level,
    unlike,
    without,
)
from swamp_rl.boat_fit.wiring import Wiring, advanced, less_advanced, search_wiring
from swamp_rl.boat_numbers.number import Number
from swamp_rl.boat_numbers.numbers import COMPASS, SATURATED, free_numbers, without_compass
from swamp_rl.criticism.data.inputs import Inputs, Named, inputs_of, read_inputs
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.likelihood.prediction_error import trivial_predictors
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.result import Predictors
from swamp_rl.errors import UserError
from swamp_rl.files import new_files_beside, refuse_existing, written_path, yaml_text
from swamp_rl.names import YAML, is_yaml
from swamp_rl.one_thread import one_thread
from swamp_rl.simulator import parameters
from swamp_rl.simulator.divergence import DivergenceError

Array = NDArray[np.float64]

REPORT = ".html"
# standard errors of the fit to short windows, from which saturation and an offset of the compass are seen
SEEN = 3.0
AT_BOUND = 1e-3  # of the prior width, within which a number is at its bound
FITS = 3  # at most, each without the runs of another thrust that the one before shows


@dataclass(frozen=True)
class _FittedFile:
    """The wiring and the fit, the numbers by it, the level of the thrust, and the boat of the file that has
    them."""

    wiring: Wiring
    fit: BoatFit
    numbers: list[Fitted]
    level: ThrustLevel
    boat: Boat


@one_thread()
def identify_boat(
    dataset: Named | Sequence[Named],
    boat: str | Path | None,
    out: Path | str,
    holdout: Named | None = None,
    positions: bool = False,
    ignore: Sequence[str] = (),
) -> Identification:
    """Fit the numbers of a boat file to runs; write the boat file `out` and a report beside it (.html).

    - `dataset`, `holdout`: datasets or their folders, `dataset` one or several of one boat. Errors are
      measured on `holdout`; without it, on every third run.
    - `boat`: name or file of the boat to start from; None for that of the (first) dataset.
    - `positions`: also fit the positions of the thrusters.
    - `ignore`: measured quantities that are not used (`wind`, `depth`).

    UserError if the data do not allow a fit, or if `out` exists.
    """
    began, out = time.perf_counter(), written_path(out)
    refuse_to_overwrite(out)
    inputs = inputs_of(dataset, boat, holdout)
    start = load_boat(inputs.boat)
    LOG.info("reading %s", inputs.label)
    run_set, other = read_inputs(inputs, start, ignore)
    data = split(run_set, other)
    with new_files_beside(out.with_suffix(REPORT), out) as (page, part):
        made, others = _fitted_to_alike(inputs, data, positions, partial(_written, part, inputs, out.stem))
        here = advanced(data.held_out, made.wiring.advance)
        alike = without(here, others.names)
        fit = made.fit
        weather = {
            of: flows
            for of in WEATHER_SD
            if (flows := run_flows(fit.problem.run_set, fit.hypothesis, fit.fit.x, fit.covariance, of))
        }
        LOG.info("gains of the thrust from the recent past")
        gains, tried = chosen_gains(advanced(data.training, made.wiring.advance), made.boat)
        found = Identification(
            start,
            made.boat,
            data,
            made.wiring,
            made.fit,
            tuple(made.numbers),
            errors_on(data.held_out, start),
            errors_on(here, made.boat),
            noise_levels(run_set),
            time.perf_counter() - began,
            others,
            errors_on(alike, made.boat) if 0 < len(alike.lengths) < len(here.lengths) else [],
            gains,
            recent_errors(here, made.boat, gains) if gains != "none" else [],
            tried,
            made.level,
            weather,
            errors_in_current(alike, made.boat) if "current" in weather and len(alike.lengths) else [],
        )
        page.write_text(page_of(found), encoding="utf-8")
    return found


def _fitted_to_alike(
    inputs: Inputs, data: Split, positions: bool, written: Callable[[Boat, list[Fitted], ThrustLevel], Boat]
) -> tuple[_FittedFile, UnlikeRuns]:
    """The fit to the training runs that have the thrust of most runs, and the runs that have another.

    These are sought with the numbers of the search of the wiring, and again with those of each fit, until the
    runs left out are those found. The thrust of the last fit is brought to the mean of the runs fitted to.
    written: the boat of the file with these numbers and this level of the thrust. UserError where its motion
    diverges.
    """
    begun = searched(data.training, positions)
    judged = len(data.training.lengths) + len(data.held_out.lengths) >= FEWEST

    def thrusts_of(numbers: list[Fitted]) -> list[RunThrust]:
        if not judged:
            return []
        try:
            return _thrusts(data, begun, written(begun.boat, numbers, ThrustLevel()))
        except DivergenceError as error:
            LOG.info("thrust of each run not estimated: %s", error.what)
            return []

    every = zip(without_compass(free_numbers(begun.boat, positions)), begun.x, strict=True)
    thrusts = thrusts_of([Fitted(one, float(x), one.sd) for one, x in every])
    for _ in range(FITS):
        rest = _without(data.training, unlike(thrusts))
        left_out = sorted(set(data.training.names) - set(rest.names))
        LOG.info("fitting to all runs%s", f" but {', '.join(left_out)}" if left_out else "")
        wiring, made = with_compass_if_seen(rest, begun, positions)
        numbers = numbers_of(made)
        thrusts = thrusts_of(numbers)
        if _without(data.training, unlike(thrusts)).names == rest.names:
            break
    level = thrust_level([one for one in thrusts if one.name in rest.names])
    found = replace(unlike(at_level(thrusts, level)), fitted=rest.names)
    try:
        boat = written(wiring.boat, numbers, level)
    except DivergenceError as error:
        raise UserError(diverging(inputs.label, error.what, numbers, data.training)) from error
    return _FittedFile(wiring, made, numbers, level, boat), found


def _without(training: RunSet, found: UnlikeRuns) -> RunSet:
    """The training runs that are like most; all of them where none is."""
    rest = without(training, found.names)
    return rest if len(rest.lengths) else training


def _thrusts(data: Split, wiring: Wiring, boat: Boat) -> list[RunThrust]:
    """The thrust of all runs as a share of the boat's."""
    LOG.info("thrust of each run")
    parts = (advanced(part, wiring.advance) for part in (data.training, data.held_out))
    return [one for part in parts for one in run_thrusts(part, boat)]


def _written(
    part: Path, inputs: Inputs, name: str, boat: Boat, numbers: list[Fitted], level: ThrustLevel
) -> Boat:
    """The boat of the file with these numbers and this level of the thrust, written to `part`.

    UserError that names the datasets where no boat has these numbers; DivergenceError where its motion
    diverges.
    """
    mapping = identified_mapping(boat, name, numbers, inputs.names, level.mean)
    part.write_text(yaml_text(mapping), encoding="utf-8")
    try:
        made = load_boat(part)
    except UserError as error:
        fault = str(error).splitlines()[0].removeprefix(f"{part}: ")
        raise UserError(implausible_fit(inputs.label, fault, numbers)) from error
    parameters(made)
    return made


def refuse_to_overwrite(out: Path) -> None:
    """UserError unless `out` is the name of a new boat file."""
    if not is_yaml(out):
        raise UserError(f"{out}: is not the name of a boat file; --out must end in {' or '.join(YAML)}")
    refuse_existing((out, out.with_suffix(REPORT)))


def searched(training: RunSet, positions: bool = False) -> Wiring:
    """The wiring of the commands."""
    LOG.info("%.1f min of runs: channels, signs and delays", training.lengths.sum() * training.dt / 60)
    return search_wiring(training, noise_levels(training), positions)


def with_compass_if_seen(training: RunSet, begun: Wiring, positions: bool) -> tuple[Wiring, BoatFit]:
    """The wiring with its numbers, and the fit of these to runs: with an offset of the compass if the fit to
    short windows and that fit show one, else without it from the beginning.
    """
    wiring, short, weather = short_fitted(training, begun, positions)
    if _is_compass_seen(short):
        made = fitted_boat(training, wiring, short, weather)
        if _is_compass_seen(numbers_of(made)):
            return wiring, made
    wiring, short, weather = short_fitted(training, begun, positions, compass=False)
    return wiring, fitted_boat(training, wiring, short, weather)


def _is_compass_seen(numbers: Sequence[Fitted]) -> bool:
    """Whether the runs support the offset of the compass, if there is one among the numbers."""
    return all(supported(one) for one in numbers if one.number.field == COMPASS)


def short_fitted(
    training: RunSet, wiring: Wiring, positions: bool = False, compass: bool = True
) -> tuple[Wiring, list[Fitted], list[str]]:
    """The wiring with the numbers of the fit to short windows, these, and which weather is significant there,
    of `wind`, unless it was measured, and `current`; compass: whether an offset of the compass is free.
    """
    every = free_numbers(wiring.boat, positions)
    numbers = every if compass else without_compass(every)
    weather = ["current"] if "wind_speed" in training.measured_fields else ["wind", "current"]
    run_set, weight, hypothesis, x = _begun(training, wiring, numbers, wiring.x, weather)
    LOG.info("fitting %d numbers to windows of %.3g s", len(numbers), SHORT)
    made = short_fit(run_set, weight, hypothesis, x)
    found = _estimates(numbers, made.x, made.covariance, made.covariance)
    kept = [
        one for one in weather if is_significant(run_flows(run_set, hypothesis, made.x, made.covariance, one))
    ]
    return less_advanced(replace(wiring, x=made.x[: len(found)]), numbers, training.dt), found, kept


def fitted_boat(training: RunSet, wiring: Wiring, short: Sequence[Fitted], weather: Sequence[str]) -> BoatFit:
    """The fit of a boat's numbers to runs, from those of the fit to short windows that these support;
    weather: of which each run has a mean.
    """
    kept = [i for i, one in enumerate(short) if supported(one)]
    LOG.info("fitting %d numbers to windows of %.3g s", len(kept), window_length(training.boat))
    numbers = tuple(short[i].number for i in kept)
    return long_fit(*_begun(training, wiring, numbers, wiring.x[kept], weather))


def supported(one: Fitted) -> bool:
    """Whether the runs support that a number is free: saturation must be seen, since it has much the same
    effect as the dead band and the coefficients of the curve together, and an offset of the compass, which
    most boats do not have. A number that starts below the least value that is fitted, as a time constant of
    0, must have left that value.
    """
    if one.number.mean < one.number.low and one.x <= one.number.low + AT_BOUND * one.number.sd:
        return False
    seen = abs(one.value - one.number.start) > SEEN * one.standard_error
    return one.number.field not in (SATURATED, COMPASS) or seen


def _begun(
    training: RunSet, wiring: Wiring, numbers: tuple[Number, ...], x: Array, weather: Sequence[str]
) -> tuple[RunSet, Array, FreeBoat, Array]:
    """Runs, weights (R, T, 6), hypothesis and x (p,) that a fit begins with, with x for the first numbers;
    with a mean of this weather for each run.
    """
    run_set = advanced(replace(training, boat=wiring.boat), wiring.advance)
    hypothesis = free_boat(wiring.boat, numbers, len(run_set.lengths), weather)
    start = hypothesis.start()
    start[: len(x)] = x
    return run_set, weights(training, noise_levels(training)), hypothesis, start


def numbers_of(made: BoatFit) -> list[Fitted]:
    """Value, standard error and prior of each number."""
    return _estimates(made.hypothesis.numbers, made.fit.x, made.covariance, made.joint_covariance)


def _estimates(numbers: Sequence[Number], x: Array, covariance: Array, joint: Array) -> list[Fitted]:
    found = []
    for i, number in enumerate(numbers):
        sd = min(float(np.sqrt(covariance[i, i])), number.sd)
        found.append(Fitted(number, float(x[i]), sd, tuple(joint[i, : i + 1].tolist())))
    return found


def errors_on(run_set: RunSet, boat: Boat) -> list[Predictors]:
    """Position errors of a boat file and of the trivial predictors on runs."""
    run_set = replace(run_set, boat=boat)
    with np.errstate(over="ignore", invalid="ignore"):
        return trivial_predictors(run_set, weights(run_set, noise_levels(run_set)))
