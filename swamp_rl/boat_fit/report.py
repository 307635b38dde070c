"""The report of an identification: one HTML page."""

import html
import math
from collections.abc import Sequence

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.boat_fit.boat_file import Fitted
from swamp_rl.boat_fit.recent_thrust import past_seconds
from swamp_rl.boat_fit.result import Identification
from swamp_rl.boat_fit.run_thrust import RunThrust
from swamp_rl.boat_numbers.number import FARTHEST
from swamp_rl.boat_numbers.numbers import SATURATED, free_numbers
from swamp_rl.criticism.data.excitation import missing_motion
from swamp_rl.criticism.data.run_set import CHANNELS, UNITS
from swamp_rl.criticism.report.evidence import TRIVIAL
from swamp_rl.criticism.result import Predictors
from swamp_rl.digits import digits, known
from swamp_rl.html_page import document, prose, table

GAINS = {"none": "no gain", "common": "one gain of all thrusters", "each": "a gain of each thruster"}
FAR = 3.0  # standard deviations of the prior, beyond which a number contradicts the start file
WIRED = (
    "The boat file has it among its effects, so pilots would drive a boat wired so. If only the log has it, "
    "correct it by the --map of runs import and identify again."
)


def page_of(found: Identification) -> str:
    """The whole HTML page."""
    title = f"Boat file {found.boat.name}, identified from runs"
    return document(
        title,
        (
            f"<h1>{html.escape(title)}</h1>",
            *(f"<p>{prose(line)}</p>" for line in summary(found)),
            "<h2>Prediction error on held-out runs</h2>",
            f"<p>{prose(held_out_sentence(found))}</p>",
            table(error_columns(found), error_rows(found), numbers=range(1, len(error_columns(found)))),
            f"<p>{prose(gains_sentence(found))}</p>",
            "<h2>Numbers</h2>",
            "<p>± is one standard error (sandwich covariance, prior included), prior ± the prior's standard "
            "deviation about the start value. Information: share of the posterior precision that the runs "
            "gave; the rest is the prior's. For masses and other numbers that keep their sign it is that of "
            "the logarithm.</p>",
            table(
                ("number", "start", "identified", "±", "prior ±", "unit", "information"),
                number_rows(found.fitted),
                numbers=(1, 2, 3, 4),
            ),
            "<h2>Residual</h2>",
            table(("channel", "noise", "residual", "unit"), residual_rows(found), numbers=(1, 2)),
            f"<p>{prose(residual_sentence(found))}</p>",
            "<h2>What to record next</h2>",
            "<ul>" + "".join(f"<li>{prose(line)}</li>" for line in next_runs(found)) + "</ul>",
        ),
    )


def summary(found: Identification) -> list[str]:
    """What was found, in sentences."""
    shown = sum(one.shown for one in found.fitted)
    lines = [
        f"{shown} of {len(found.fitted)} numbers are fitted to the runs; the others keep their prior.",
        *left_out(found.wiring.boat, found.fitted),
        *(f"Commands: {change}. {WIRED}" for change in found.wiring.changes),
    ]
    if found.wiring.advance > 0.0:
        lines.append(
            f"Commands are stamped {found.wiring.advance:g} s after the motion that they cause. They were "
            "taken that much earlier. A boat file has no parameter for it: import the runs again with "
            f"--commands-earlier {found.wiring.advance:g}."
        )
    if found.level.standard_error > 0.0:
        level = f"{found.level.mean:.3f} ± {found.level.standard_error:.3f} (one standard error)"
        lines.append(
            f"The thrust of the fit is multiplied by {level}, the mean of the runs that it is fitted to "
            "(effect `thrust_scale`)."
        )
    lines += unlike_runs(found)
    lines += far_from_start(found.fitted)
    lines += [prediction_sentence(found), start_sentence(found.before, found.predicted)]
    if found.alike:
        errors = "; ".join(
            f"{one.horizon_s:g} s ahead {one.boat_file:.3g} m ("
            + ", ".join(f"{TRIVIAL[name]} {getattr(one, name):.3g} m" for name in TRIVIAL)
            + ")"
            for one in found.alike
        )
        worse = not_better(found.alike)
        better = f"not better than {' and '.join(worse)}" if worse else "better than each of these"
        lines.append(f"Without gains, on the held-out runs of usual thrust, it is {better}: {errors}.")
    return lines


def left_out(boat: Boat, fitted: Sequence[Fitted]) -> list[str]:
    """Which numbers the first windows leave out of the fit, in sentences."""
    free = {one.number.name for one in fitted}
    out = [one for one in free_numbers(boat) if one.name not in free]
    thrusters = ", ".join(one.name.rpartition(".")[2] for one in out if one.field == SATURATED)
    lags = ", ".join(one.name for one in out if one.field != SATURATED)
    return [
        f"The runs show no {what} {names}: it is as in the start file."
        for what, names in (("saturation of the thrust of", thrusters), ("time constant", lags))
        if names
    ]


def prediction_sentence(found: Identification) -> str:
    """Whether the boat predicts better than the trivial predictors, as it is to be used."""
    file = "The identified file"
    if found.gains == "none":
        return f"{file} is {_than(not_better(found.after))}."
    past = f"at most {past_seconds(found.boat):.3g} s before each prediction"
    return (
        f"{file} with {GAINS[found.gains]} from the past of the same run, {past}, is "
        f"{_than(not_better(found.predicted))}; without, it is {_than(not_better(found.after))}."
    )


def start_sentence(before: Sequence[Predictors], after: Sequence[Predictors]) -> str:
    """Whether the boat predicts better than that of the start file, as it is to be used."""
    start = {one.horizon_s: one.boat_file for one in before}
    worse = [f"{one.horizon_s:g} s" for one in after if one.boat_file >= start.get(one.horizon_s, math.inf)]
    if not worse:
        return "It is better than the start file at each horizon."
    return f"It is not better than the start file {' and '.join(worse)} ahead."


def _than(worse: Sequence[str]) -> str:
    """That it is better than every trivial predictor, or not than some."""
    return (
        f"not better than {' and '.join(worse)}"
        if worse
        else "better than every trivial predictor at each horizon"
    )


def gains_sentence(found: Identification) -> str:
    """Which gains of the thrust predict the training runs best, with their errors."""
    tried = {
        name: ", ".join(f"{one.position:.3g} m at {one.horizon_s:g} s" for one in errors) or "none finite"
        for name, errors in found.recent_training.items()
    }
    errors = "; ".join(f"{GAINS[name]}: {error}" for name, error in tried.items())
    use = "not used" if found.gains == "none" else f"used: {GAINS[found.gains]}"
    return (
        f"Gains of the thrust from the past of the same run are {use}. They are chosen by the errors on the "
        f"training runs ({errors})."
    )


def unlike_runs(found: Identification) -> list[str]:
    """Runs that are not like the others, in a sentence each."""
    return [
        *(
            f"In {one.name} the thrust is {one.share:.2f} ± {one.standard_error:.2f} (one standard error) of "
            "the identified boat's under the same commands, unlike in most runs: weed, a tow, a flat "
            f"battery, or commands that did not arrive. The run is {_use(one, found)}."
            for one in found.unlike.thrust
        ),
        *(
            f"In {one.name} the logged commands explain {max(one.explained, 0.0):.0%} of the motion, at any "
            f"thrust, unlike in most runs: a remote control, a tow, or commands of another time. The run is "
            f"{_use(one, found)}."
            for one in found.unlike.commands
        ),
    ]


def _use(one: RunThrust, found: Identification) -> str:
    """What a run is used for."""
    if one.name in found.data.held_out.names:
        return "held out"
    return "part of the fit" if one.name in found.unlike.fitted else "left out of the fit"


def far_from_start(fitted: Sequence[Fitted]) -> list[str]:
    """Which numbers contradict the start file, and which are at the bound of the fit, in sentences."""
    far = [one for one in fitted if one.distance > FAR]
    if not far:
        return []
    named = ", ".join(f"{one.number.name} ({one.distance:.1f})" for one in far)
    lines = [
        f"More than {FAR:g} standard deviations of the prior from the start file: {named}. There "
        "the start file is wrong or its `sd` too small, or the motion has a cause without a number in a boat "
        "file, which `swamp-rl diagnose` seeks."
    ]
    if ended := [one.number.name for one in far if one.distance > 0.999 * FARTHEST]:
        lines.append(
            f"At the bound of the fit, {FARTHEST:g} standard deviations of the prior: {', '.join(ended)}. "
            "The value is that of the bound, not of the runs: the prior or the model is wrong."
        )
    return lines


def not_better(errors: Sequence[Predictors]) -> list[str]:
    """Trivial predictors that the identified file does not beat, with their horizon."""
    return [
        f"{TRIVIAL[name]} {one.horizon_s:g} s ahead"
        for one in errors
        for name in TRIVIAL
        if one.boat_file >= getattr(one, name)
    ]


def held_out_sentence(found: Identification) -> str:
    """Which data the errors are measured on."""
    data = found.data
    minutes = [float(part.lengths.sum()) * part.dt / 60 for part in (data.training, data.held_out)]
    by = {
        "runs": "every third run",
        "lengths": "every third run in the order of their lengths",
        "pieces": "every third piece of the runs",
        "folder": "other runs",
    }[data.by]
    return (
        f"Root mean square position error, m. Fitted to {minutes[0]:.1f} min, held out {minutes[1]:.1f} min "
        f"({by}). Predictions start from the smoothed measured state."
    )


def error_columns(found: Identification) -> tuple[str, ...]:
    """Heads of `error_rows`."""
    identified = ("identified",) if found.gains == "none" else ("identified with gains", "without gains")
    return ("horizon", "start file", *identified, *TRIVIAL.values())


def error_rows(found: Identification) -> list[tuple[str, ...]]:
    """Errors [m] by horizon: start file, identified with the gains where they are used and without, trivial
    predictors."""
    before = {was.horizon_s: f"{was.boat_file:.3g}" for was in found.before}
    rows = []
    for now, alone in zip(found.predicted, found.after, strict=True):
        own = [one.boat_file for one in ([now] if found.gains == "none" else [now, alone])]
        cells = [f"{error:.3g}" if np.isfinite(error) else "diverges" for error in own]
        trivial = [f"{getattr(now, name):.3g}" for name in TRIVIAL]
        rows.append((f"{now.horizon_s:g} s", before.get(now.horizon_s, "diverges"), *cells, *trivial))
    return rows


def number_rows(fitted: Sequence[Fitted]) -> list[tuple[str, ...]]:
    """Every number that was free."""
    return [
        (
            one.number.name,
            digits(one.number.start, 4),
            known(one.value, one.standard_error),
            digits(one.standard_error, 2),
            digits(one.prior_sd, 2),
            one.number.unit,
            f"{one.information:.0%}" + ("" if one.shown else ", prior kept"),
        )
        for one in fitted
    ]


def residual_rows(found: Identification) -> list[tuple[str, ...]]:
    """Standard deviations of the sensors' noise and of the residual by channel."""
    return [
        (name, f"{noise:.3g}", f"{sigma:.3g}", unit)
        for name, unit, noise, sigma in zip(CHANNELS, UNITS, found.noise, found.made.sigma, strict=True)
        if np.isfinite(noise)
    ]


def residual_sentence(found: Identification) -> str:
    """Windows and independent samples."""
    problem = found.made.problem
    seconds = problem.correlation_samples * problem.dt
    return (
        f"Windows of {problem.seconds:.3g} s, {problem.windows.count} of them. The fit counts one "
        f"independent sample every {seconds:.2g} s. A residual well above the noise is gusts, or forces that "
        "the model has no number for: `swamp-rl diagnose` looks for these."
    )


def next_runs(found: Identification) -> list[str]:
    """Motions that would show the numbers that the runs do not show."""
    lacking: dict[str, list[str]] = {}
    for one in found.fitted:
        if not one.shown:
            lacking.setdefault(one.number.trial, []).append(one.number.name)
    lines = [f"{trial}: for {', '.join(names)}" for trial, names in lacking.items()]
    return [*lines, *missing_motion(found.data.training, False)] or ["The runs show every number."]
