"""Identification of a boat file from a folder of runs."""

import os
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat_fit.boat_file import Fitted, identified_mapping
from swamp_rl.boat_fit.fit import BoatFit, fit_boat
from swamp_rl.boat_fit.hypothesis import free_boat
from swamp_rl.boat_fit.numbers import free_numbers
from swamp_rl.boat_fit.pieces import Split, split
from swamp_rl.boat_fit.recent_thrust import recent_errors
from swamp_rl.boat_fit.report import page_of
from swamp_rl.boat_fit.result import Identification
from swamp_rl.boat_fit.run_thrust import FEWEST, RunThrust, run_thrusts, with_other_thrust, without
from swamp_rl.boat_fit.wiring import Wiring, advanced, search_wiring
from swamp_rl.criticism.data.checks import refuse_other_vehicle
from swamp_rl.criticism.data.consistency import refuse_inconsistent
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet, read_run_set
from swamp_rl.criticism.likelihood.prediction_error import trivial_predictors
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.result import Predictors
from swamp_rl.errors import UserError
from swamp_rl.files import write_beside, yaml_text
from swamp_rl.one_thread import one_thread

Array = NDArray[np.float64]

SUFFIX, REPORT = ".yaml", ".html"


@dataclass(frozen=True)
class _FittedFile:
    """The wiring and the fit, the numbers by it, and the boat of the file that has them."""

    wiring: Wiring
    fit: BoatFit
    numbers: list[Fitted]
    boat: Boat


@one_thread()
def identify_boat(
    dataset: Path | str,
    boat: str | Path,
    out: Path | str,
    holdout: Path | str | None = None,
    positions: bool = False,
    ignore: Sequence[str] = (),
) -> Identification:
    """Fit the numbers of a boat file to a folder of runs; writes the boat file `out` and, beside it, a report
    of the same name, .html.

    holdout: a folder of runs that the errors are measured on; without it every third run; positions: also fit
    where the thrusters are; ignore: measured weather that is left out (`wind`, `depth`). UserError for data
    that no fit is possible from, and where `out` is there already.
    """
    dataset, out = Path(dataset), Path(out)
    began = time.perf_counter()
    refuse_to_overwrite(out)
    start = load_boat(boat)
    if holdout is not None:
        refuse_other_vehicle(dataset, Path(holdout))
    LOG.info("reading %s", dataset)
    run_set = _read(dataset, start, boat, ignore)
    other = _read(Path(holdout), start, boat, ignore) if holdout is not None else None
    data = split(run_set, other)
    with ExitStack() as files:
        part, page = (files.enter_context(write_beside(path)) for path in (out, out.with_suffix(REPORT)))
        made, others = _fitted_to_alike(data, partial(_fitted_file, part, dataset, out.stem, positions))
        here = advanced(data.held_out, made.wiring.advance)
        alike = without(here, {one.name for one in others})
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
            tuple(others),
            errors_on(alike, made.boat) if 0 < len(alike.lengths) < len(here.lengths) else [],
            recent_errors(here, made.boat),
        )
        page.write_text(page_of(found), encoding="utf-8")
    return found


def _fitted_to_alike(
    data: Split, fit_to: Callable[[RunSet, _FittedFile | None], _FittedFile]
) -> tuple[_FittedFile, list[RunThrust]]:
    """The fit to the training runs that have the thrust of most runs, and the runs that have another."""
    made = fit_to(data.training, None)
    others = with_other_thrust(_thrusts(data, made))
    left_out = {one.name for one in others} & set(data.training.names)
    rest = without(data.training, left_out)
    if not left_out or not len(rest.lengths):
        return made, others
    LOG.info("without %s", ", ".join(sorted(left_out)))
    made = fit_to(rest, made)
    thrusts = _thrusts(data, made)
    names = left_out | {one.name for one in with_other_thrust(thrusts)}
    return made, [one for one in thrusts if one.name in names]


def _thrusts(data: Split, made: _FittedFile) -> list[RunThrust]:
    """The thrust of all runs; nothing where there are too few to compare."""
    if len(data.training.lengths) + len(data.held_out.lengths) < FEWEST:
        return []
    LOG.info("thrust of each run")
    parts = (advanced(part, made.wiring.advance) for part in (data.training, data.held_out))
    return [one for part in parts for one in run_thrusts(part, made.boat)]


def _fitted_file(
    part: Path, dataset: Path, name: str, positions: bool, training: RunSet, before: _FittedFile | None
) -> _FittedFile:
    """The fit to runs, its file written to `part` and loaded again; before: a fit to more runs, which has
    their wiring, and numbers to begin with.
    """
    known = None if before is None else replace(before.wiring, x=before.fit.fit.x[: len(before.numbers)])
    wiring, made = fitted_boat(training, positions, known)
    numbers = numbers_of(made)
    mapping = identified_mapping(wiring.boat, name, numbers, _told(dataset))
    part.write_text(yaml_text(mapping), encoding="utf-8")
    return _FittedFile(wiring, made, numbers, _loaded(part, dataset))


def refuse_to_overwrite(out: Path) -> None:
    """UserError unless `out` is the name of a new boat file."""
    if out.suffix != SUFFIX:
        raise UserError(f"{out}: is no name of a boat file; let --out end in {SUFFIX}")
    for path in (out, out.with_suffix(REPORT)):
        if os.path.lexists(path):
            raise UserError(f"{path}: already exists; name another --out or remove it")


def _read(folder: Path, boat: Boat, named: str | Path, ignore: Sequence[str]) -> RunSet:
    run_set = read_run_set(folder, boat, named, ignore)
    refuse_inconsistent(run_set, str(folder))
    return run_set


def _loaded(part: Path, dataset: Path) -> Boat:
    """The written boat; UserError that names the dataset where its numbers are of no boat."""
    try:
        return load_boat(part)
    except UserError as error:
        fault = str(error).splitlines()[0].removeprefix(f"{part}: ")
        raise UserError(
            f"{dataset}: the fitted numbers are of no boat: {fault}; check the start file"
        ) from error


def _told(dataset: Path) -> str:
    return dataset.resolve().name or "runs"


def fitted_boat(
    training: RunSet, positions: bool = False, known: Wiring | None = None
) -> tuple[Wiring, BoatFit]:
    """The wiring of the commands, unless known, and the fit of a boat's numbers to runs."""
    weight = weights(training, noise_levels(training))
    wiring = known or _searched(training, weight, positions)
    run_set = advanced(replace(training, boat=wiring.boat), wiring.advance)
    windy = "wind_speed" not in run_set.measured_fields
    numbers = free_numbers(wiring.boat, positions)
    hypothesis = free_boat(wiring.boat, numbers, len(run_set.lengths) if windy else 0)
    x = hypothesis.start()
    x[: len(numbers)] = wiring.x
    LOG.info("fitting %d numbers", len(numbers))
    return wiring, fit_boat(run_set, weight, hypothesis, x)


def _searched(training: RunSet, weight: Array, positions: bool) -> Wiring:
    LOG.info("%.1f min of runs: channels, signs and delays", training.lengths.sum() * training.dt / 60)
    return search_wiring(training, weight, positions)


def numbers_of(made: BoatFit) -> list[Fitted]:
    """Value, standard error and prior of each number."""
    found = []
    for i, number in enumerate(made.hypothesis.numbers):
        x, sd = float(made.fit.x[i]), float(np.sqrt(made.covariance[i, i]))
        found.append(
            Fitted(number, number.value(x), number.spread(x, min(sd, number.sd)), number.spread(x, number.sd))
        )
    return found


def errors_on(run_set: RunSet, boat: Boat) -> list[Predictors]:
    """Position errors of a boat file and of the trivial predictors on runs."""
    run_set = replace(run_set, boat=boat)
    with np.errstate(over="ignore", invalid="ignore"):
        return trivial_predictors(run_set, weights(run_set, noise_levels(run_set)))
