"""The report of an identification: one HTML page."""

import html
import math
from collections.abc import Sequence

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.boat_fit.boat_file import Fitted
from swamp_rl.boat_fit.fit import window_length
from swamp_rl.boat_fit.recent_thrust import RecentErrors, past_seconds
from swamp_rl.boat_fit.result import Identification
from swamp_rl.boat_fit.run_flow import RunFlow
from swamp_rl.boat_fit.run_thrust import RunThrust
from swamp_rl.boat_numbers.number import FARTHEST
from swamp_rl.boat_numbers.numbers import COMPASS, SATURATED, free_numbers
from swamp_rl.criticism.data.excitation import missing_motion
from swamp_rl.criticism.data.run_set import CHANNELS, UNITS
from swamp_rl.criticism.likelihood.prediction_error import TRIVIAL
from swamp_rl.criticism.result import Predictors
from swamp_rl.digits import digits, known
from swamp_rl.html_page import document, prose, table, with_error
from swamp_rl.simulator.reference import reference_of

GAINS = {"none": "no gain", "common": "one gain of all thrusters", "each": "a gain of each thruster"}
HEADS = tuple(name.replace("_", " ") for name in TRIVIAL)
DIRECTION = {"wind": "from", "current": "sets toward"}
FEWEST_PASSED = 3.0  # lengths at full speed in a window, in which a ship's response to its rudder is over
FAR = 3.0  # standard deviations of the prior, beyond which a number contradicts the start file
WIRED = (
    "The boat file has it among its effects, so pilots would drive a boat with this wiring. If only the log "
    "has it, correct the log with `runs import --map` and identify again. If the start file is wrong, "
    "correct the file and identify again."
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
            *usual_thrust(found),
            "<h2>Numbers</h2>",
            "<p>±: one standard error (sandwich covariance, prior included). Prior ±: standard deviation of "
            "the prior about the start value. Information: share of the posterior precision that is from the "
            "runs; the rest is from the prior. For numbers that keep their sign, such as masses, it is the "
            "share for the logarithm.</p>",
            table(
                ("number", "start", "identified", "±", "prior ±", "unit", "information"),
                number_rows(found.fitted),
                numbers=(1, 2, 3, 4),
                unbroken=(5, 6),
            ),
            "<h2>Residual</h2>",
            table(("channel", "noise", "residual", "unit"), residual_rows(found), numbers=(1, 2)),
            f"<p>{prose(residual_sentence(found))}</p>",
            *weather_of_runs(found),
            "<h2>What to record next</h2>",
            "<ul>" + "".join(f"<li>{prose(line)}</li>" for line in next_runs(found)) + "</ul>",
        ),
    )


def summary(found: Identification) -> list[str]:
    """What was found, in sentences."""
    shown = sum(one.shown for one in found.fitted)
    lines = [
        f"The runs determine {shown} of {len(found.fitted)} free numbers; the others keep "
        "the standard deviations of their priors.",
        prediction_sentence(found),
        start_sentence(found.before, found.predicted),
        *short_windows(found.boat),
        *left_out(found.wiring.boat, found.fitted),
        *(f"Commands: {change}. {WIRED}" for change in found.wiring.changes),
    ]
    if found.wiring.advance > 0.0:
        lines.append(
            f"The log stamps commands {found.wiring.advance:g} s after the motion that they cause. The fit "
            "corrects this; a boat file has no parameter for it. Import the runs again with "
            f"`--commands-earlier {found.wiring.advance:g}`."
        )
    lines += compass_offset(found.fitted)
    if found.level.standard_error > 0.0:
        level = with_error(found.level.mean, found.level.standard_error)
        lines.append(
            f"All thrusts are multiplied by {level}, the mean thrust factor of the fitted runs (effect "
            "`thrust_scale`)."
        )
    return [*lines, *moving_water(found), *unlike_runs(found), *far_from_start(found.fitted)]


def short_windows(boat: Boat) -> list[str]:
    """That the last windows are short for the boat, in a sentence; none where they are not."""
    seconds = window_length(boat)
    passed = seconds * reference_of(boat).speed / boat.length
    if passed >= FEWEST_PASSED:
        return []
    return [
        f"In the longest windows of the fit, {seconds:.0f} s, the boat passes {passed:.1g} lengths at full "
        "speed, less than its response to steering takes: import a ship's runs at the scale of a model by "
        "Froude's law, lengths over the scale and times over its square root, and identify a boat file of "
        "that scale."
    ]


def compass_offset(fitted: Sequence[Fitted]) -> list[str]:
    """The offset of the compass that the fit found, in a sentence; none where it is not significant."""
    return [
        f"The compass reads {known(abs(angle), error)} ± {digits(error, 2)} degrees (one standard error) too "
        f"far {'clockwise' if angle > 0.0 else 'counterclockwise'} (effect `heading_bias`): the track over "
        "ground differs from the heading by this angle on all courses. The fit corrects this. The boat file "
        "has it among its effects, so pilots would drive a boat with this compass. If only the log has it, "
        f"import the log again with `--map 'heading=HEADING - radians({angle:.3g})'`, HEADING being the "
        "expression in rad that the heading was mapped to, and identify again."
        for one in fitted
        if one.number.field == COMPASS
        for angle, error in [(math.degrees(one.value), math.degrees(one.standard_error))]
    ]


def left_out(boat: Boat, fitted: Sequence[Fitted]) -> list[str]:
    """Which numbers the first windows leave out of the fit, in sentences."""
    free = {one.number.name for one in fitted}
    out = [one for one in free_numbers(boat) if one.name not in free]
    thrusters = ", ".join(one.name.rpartition(".")[2] for one in out if one.field == SATURATED)
    lags = ", ".join(one.name for one in out if one.field not in (SATURATED, COMPASS))
    kept = (
        f"saturation of the thrust of {thrusters}" if thrusters else "",
        f"time constants {lags}" if lags else "",
        "offset of the compass" if any(one.field == COMPASS for one in out) else "",
    )
    return [f"Not significant in the runs, kept as in the start file: {one}." for one in kept if one]


def prediction_sentence(found: Identification) -> str:
    """Whether the boat predicts better than the trivial predictors, as it is to be used."""
    alone = f"the identified file {_than(not_better(found.after))}."
    if found.gains == "none":
        return f"On held-out runs {alone}"
    return (
        f"On held-out runs the identified file with {GAINS[found.gains]}, estimated from at most the last "
        f"{past_seconds(found.boat):.3g} s of the same run, {_than(not_better(found.predicted))}. "
        f"Without gains {alone}"
    )


def start_sentence(before: Sequence[Predictors], after: Sequence[Predictors]) -> str:
    """Whether the boat predicts better than that of the start file, as it is to be used."""
    start = {one.horizon_s: one.boat_file for one in before}
    worse = [f"{one.horizon_s:g} s" for one in after if one.boat_file >= start.get(one.horizon_s, math.inf)]
    if not worse:
        return "It predicts better than the start file at each horizon."
    return f"It does not predict better than the start file {', '.join(worse)} ahead."


def _than(worse: Sequence[str]) -> str:
    """That it is better than every trivial predictor, or not than some."""
    return (
        f"does not predict better than {' and '.join(worse)}"
        if worse
        else "predicts better than every trivial predictor at each horizon"
    )


def gains_sentence(found: Identification) -> str:
    """Which gains of the thrust predict the training runs best, with their errors."""
    errors = "; ".join(f"{GAINS[name]}: {by_horizon(one)}" for name, one in found.recent_training.items())
    use = "not used" if found.gains == "none" else f"used: {GAINS[found.gains]}"
    return (
        f"Gains of the thrust, estimated from the past of the same run, are {use}. The choice minimises the "
        f"mean log position error on the training runs ({errors})."
    )


def by_horizon(errors: Sequence[RecentErrors]) -> str:
    """Position errors at their horizons, in words."""
    return ", ".join(f"{one.position:.3g} m at {one.horizon_s:g} s" for one in errors) or "none finite"


def moving_water(found: Identification) -> list[str]:
    """The currents that were fitted, in a sentence."""
    if "current" not in found.weather:
        return []
    speeds = [one.speed for one in found.weather["current"]]
    like = " whose thrust factor is that of most runs" if found.unlike.names else ""
    errors = (
        f" In the mean current of each held-out run{like}, fitted to that run itself, the position errors "
        f"without gains are {by_horizon(found.in_current)}."
    )
    return [
        f"The water moved: a mean current of each run, {min(speeds):.2f} to {max(speeds):.2f} m/s, was "
        "fitted beside the numbers. The boat file is for still water; `swamp-rl diagnose` estimates the "
        f"current of other runs.{errors if found.in_current else ''}"
    ]


def weather_of_runs(found: Identification) -> list[str]:
    """A table of the winds and currents of the runs fitted to; empty where neither was fitted."""
    if not found.weather:
        return []
    heads = [head for of in found.weather for head in (f"{of}, m/s", "±", f"{DIRECTION[of]}, degrees")]
    rows = [
        (flows[0].name, *(cell for one in flows for cell in flow_cells(one)))
        for flows in zip(*found.weather.values(), strict=True)
    ]
    return [
        f"<h2>{' and '.join(found.weather).capitalize()} of the runs</h2>",
        "<p>Mean of each run fitted to, estimated beside the numbers. ±: one standard error of the speed, "
        "prior included. The boat file and the predictions above are without them; "
        "<code>swamp-rl diagnose</code> estimates those of other runs.</p>",
        table(("run", *heads), rows, numbers=range(1, 1 + len(heads))),
    ]


def flow_cells(flow: RunFlow) -> tuple[str, str, str]:
    """Speed [m/s], its standard error and the direction [degrees], clockwise from north."""
    degrees = math.degrees(math.atan2(flow.east, flow.north)) % 360.0
    return known(flow.speed, flow.standard_error), digits(flow.standard_error, 2), f"{degrees:.0f}"


def unlike_runs(found: Identification) -> list[str]:
    """Runs that are not like the others, in a sentence each."""
    return [
        *(
            f"{one.name}: the thrust factor is {with_error(one.share, one.standard_error)}, unlike in most "
            "runs. Possible causes: weed, towing, a weak battery, lost commands. The run is "
            f"{_use(one, found)}."
            for one in found.unlike.thrust
        ),
        *(
            f"{one.name}: the logged commands explain {max(one.explained, 0.0):.0%} of the motion at the "
            "best thrust factor, less than in most runs. Possible causes: a remote control, towing, commands "
            f"of another time. The run is {_use(one, found)}."
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
        f"More than {FAR:g} standard deviations of the prior from the start file: {named}. Either the start "
        "file is wrong there, or its `sd` is too small, or the motion has a cause that is not a number of a "
        "boat file. `swamp-rl diagnose` searches for such causes."
    ]
    if ended := [one.number.name for one in far if one.distance > 0.999 * FARTHEST]:
        lines.append(
            f"At the bound of the fit, {FARTHEST:g} standard deviations of the prior: {', '.join(ended)}. "
            "The value is that of the bound, not of the runs: the prior or the model is wrong."
        )
    return lines


def not_better(errors: Sequence[Predictors]) -> list[str]:
    """Trivial predictors that the identified file does not beat, with their horizons."""
    worse = {
        words: [f"{one.horizon_s:g}" for one in errors if one.boat_file >= getattr(one, name)]
        for name, words in TRIVIAL.items()
    }
    return [f"{words} ({', '.join(horizons)} s ahead)" for words, horizons in worse.items() if horizons]


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
    return ("horizon", "start file", *identified, *HEADS)


def usual_thrust(found: Identification) -> list[str]:
    """Errors without gains on the held-out runs whose thrust is that of most runs; empty if that is all."""
    if not found.alike:
        return []
    rows = [
        (f"{one.horizon_s:g} s", f"{one.boat_file:.3g}", *(f"{getattr(one, name):.3g}" for name in TRIVIAL))
        for one in found.alike
    ]
    return [
        "<p>Without gains, on the held-out runs whose thrust factor is that of most runs:</p>",
        table(("horizon", "without gains", *HEADS), rows, numbers=range(1, 2 + len(HEADS))),
    ]


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
        f"independent sample every {seconds:.2g} s. A residual well above the noise is due to gusts or to "
        "forces that the model does not contain; `swamp-rl diagnose` searches for them."
    )


def next_runs(found: Identification) -> list[str]:
    """Motions from which the numbers that the runs do not determine are identifiable."""
    lacking: dict[str, list[str]] = {}
    for one in found.fitted:
        if not one.shown:
            lacking.setdefault(one.number.trial, []).append(one.number.name)
    lines = [f"{trial}: for {', '.join(names)}" for trial, names in lacking.items()]
    return [*lines, *missing_motion(found.data.training, False)] or [
        "Nothing: the runs determine every number."
    ]
