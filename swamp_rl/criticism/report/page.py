"""The report as one HTML page: sentences, tables and figures."""

import base64
import html
from collections.abc import Mapping
from pathlib import Path

from swamp_rl.counted import counted
from swamp_rl.criticism.data.measurement_noise import noise_floor
from swamp_rl.criticism.data.run_set import CHANNELS, RunSet
from swamp_rl.criticism.inference.finding import Finding
from swamp_rl.criticism.likelihood.prediction_error import QUANTITIES
from swamp_rl.criticism.report.evidence import (
    carry_over_sentence,
    minor_sentence,
    predictor_rows,
    predictors_sentence,
    self_trial_section,
    share_rows,
    smoothed_sentence,
)
from swamp_rl.criticism.report.extension import extension_section
from swamp_rl.criticism.report.figures import (
    DEGREES,
    SHOWN,
    draw,
    draw_errors,
    draw_forces,
    draw_missing,
    draw_tracks,
)
from swamp_rl.criticism.report.next_trial import draw_next_trial, next_trial_section
from swamp_rl.criticism.report.words import (
    ENOUGH,
    GAINED_ON,
    cause_rows,
    closeness,
    effects_listed,
    files_sentence,
    force_name,
    gain_sentence,
    headline,
    is_extended,
    manoeuvre_words,
    meaning,
    noise_sentence,
    readable,
    rest_sentence,
    separates,
    separating_sentence,
    shape_sentence,
    shown_unit,
)
from swamp_rl.criticism.result import Diagnosis, Gain
from swamp_rl.html_page import document, image, minus, places_of, plain, rounded, table

PREDICTORS = ("seconds ahead", "boat file", "at rest", "constant velocity", "no thrust")
REDUCTION = "reduction (95 % interval)"
SHARES = ("cause", "error, horizon", "without", "with", "share", REDUCTION, "prediction moved by", "unit")
CAUSES = ("effect", "description", "parameter", "value", "95 % interval", "unit", "boat file")
CHI2 = (
    "χ² is the sum of squared errors over the variance of the measurement noise, or of the model error if "
    "effects are selected under it. Its mean is 1 an independent sample for that noise or error alone."
)


def page(found: Diagnosis, run_set: RunSet, images: Mapping[str, str], data: str) -> str:
    """The whole HTML page; images: PNG in base64 by name; data: what the runs are called."""
    parts = [
        opening(found, run_set, data),
        errors_section(found, images),
        causes_section(found, run_set),
        identifiability_section(found, run_set),
        next_trial_section(found, images),
        self_trial_section(found),
        residual_section(found, images),
        extension_section(found, run_set.boat),
        gain_section(found),
        limits_section(found, run_set),
        details(found, run_set),
    ]
    return document(f"{data}: diagnosis of the model of {run_set.boat.name}", parts)


def opening(found: Diagnosis, run_set: RunSet, data: str) -> str:
    """The verdict, what must be known before the causes are read, the meaning, and the data."""
    minutes = float(run_set.lengths.sum()) * run_set.dt / 60.0
    first = (predictors_sentence(found), carry_over_sentence(found), minor_sentence(found))
    markup = "".join(f"<p><b>{html.escape(one)}</b></p>" for one in first if one)
    return (
        f'<span class="badge {found.verdict}">{found.verdict.replace("_", " ")}</span>'
        f"<h1>{html.escape(headline(found))}</h1>{markup}<p>{html.escape(meaning(found))}</p>"
        f'<p class="soft">Boat file <b>{html.escape(run_set.boat.name)}</b> against '
        f"{counted(len(run_set.lengths), 'run')} of <b>{html.escape(data)}</b>, "
        f"{minutes:.1f} minutes in all, {1 / run_set.dt:.3g} samples a second.</p>"
    )


def cards(found: Diagnosis) -> str:
    """Position and heading error ten seconds ahead, without and with the causes."""
    gain = min(found.gain, key=lambda one: abs(one.horizon_s - 10.0), default=None)
    if gain is None:
        return ""
    made = []
    for name in ("position_rmse_m", "heading_rmse_rad"):
        paired = getattr(gain, name)
        if paired is None:
            continue
        title, unit, factor, _ = SHOWN[name]
        after = f" → {rounded(factor * paired.after)}" if is_extended(found) else ""
        made.append(
            f'<div class="card"><b>{rounded(factor * paired.before)}{after} {unit}</b>'
            f"<span>{title} error {gain.horizon_s:g} s ahead</span></div>"
        )
    return f'<div class="cards">{"".join(made)}</div>'


def errors_section(found: Diagnosis, images: Mapping[str, str]) -> str:
    """Tracks, errors by horizon, and residual forces."""
    noise = ""
    if found.verdict == "nothing_wrong":
        noise = " Here they are not distinguishable from the effect of noise."
    perfect = (
        " The dashed line is the error of a perfect model that starts from a state with the noise given "
        "under Details. An error above it is a model error. An error far below it means that this noise is "
        "mostly integration error."
    )
    if found.gain_on == "other_runs":
        perfect = " These are the held-out runs; the tracks above are those diagnosed."
    return (
        "<h2>Prediction error</h2><p>Simulations restarted at regular intervals from the measured state, and "
        "the measured track.</p>"
        + image(images["tracks"], "Measured and predicted tracks")
        + f"<p>Prediction error (root mean square) against the horizon.{perfect}</p>"
        + image(images["errors"], "Prediction error by horizon")
        + "<p>Position error [m] of the boat file and of predictors that need no model:</p>"
        + table(PREDICTORS, predictor_rows(found), numbers=(0, 1, 2, 3, 4))
        + "<p>Missing forces as functions of the boat's motion and commands. Added to the model, they "
        "reproduce the measured motion. A dependence on heading indicates a cause fixed to the earth (wind, "
        "current); on throttle or azimuth, the thrusters; on speed or yaw rate, the hull. Dots: single "
        f"estimates. Lines: means of bins ± one standard error.{noise}</p>"
        + image(images["forces"], "Missing forces")
    )


def causes_section(found: Diagnosis, run_set: RunSet) -> str:
    """The causes with their parameters."""
    if not found.causes:
        return ""
    titles = {"unexplained": "Partial causes", "indistinguishable": "The explanation with the lowest χ²"}
    title = titles.get(found.verdict, "Causes")
    rows = cause_rows(found.causes, run_set.boat)
    note = ""
    if found.nuisance:
        names = readable(" + ".join(cause.label for cause in found.nuisance)).capitalize()
        note = (
            f"<p>{html.escape(names)} were fitted together with it, with a prior about the boat file; "
            "<code>diagnosis.json</code> has them as <code>nuisance</code>.</p>"
        )
    if found.verdict == "unexplained":
        note += (
            "<p>These explain a part of the model error. Another part remains: each of them may be a "
            "substitute for an effect that is not in the library.</p>"
        )
    shares = (
        "<p>Share of each cause: prediction errors on held-out runs without the cause, the others being "
        "fitted again, and with it. Shares need not add up to 100 %. A cause with a share of zero or less "
        "does not reduce that error; it is listed if it is significant and moves a prediction by more than "
        "the sensor's noise. A cause that differs between runs has no share on runs that it was not fitted "
        "to, nor has the weather of the diagnosed runs on held-out runs predicted no better with it: "
        "they may be of another day.</p>"
    )
    accounts = share_rows([*found.causes, *found.minor])
    if accounts:
        shares += table(SHARES, accounts, numbers=(2, 3, 4, 5, 6))
    return f"<h2>{title}</h2>{note}" + table(CAUSES, rows, numbers=(3, 4, 6), unbroken=(2,)) + shares


def identifiability_section(found: Diagnosis, run_set: RunSet) -> str:
    """The indistinguishable hypotheses, their similarity, and the manoeuvre that separates them."""
    if not found.indistinguishable:
        return ""
    rows = [
        (
            " <b>or</b> ".join(html.escape(readable(name)) for name in one.effects),
            f"{DEGREES * one.angle:.1f}°",
            minus(f"{one.evidence:.1f}"),
            minus(f"{one.mutual_refit:.1f}"),
        )
        for one in found.contrasts
    ]
    heads = ("explanations", "angle between sensitivities", "worse by [χ²]", "remaining after refit [χ²]")
    return (
        "<h2>Why they cannot be distinguished</h2><p>The angle is that between the sensitivities of the "
        "predictions to two explanations: the smaller, the better one substitutes the other. "
        f"{html.escape(closeness(found.verdict))} {CHI2}</p>"
        + table(heads, rows, numbers=(1, 2, 3), raw=True)
        + rivals_numbers(found, run_set)
        + separating_manoeuvre(found, run_set)
    )


def rivals_numbers(found: Diagnosis, run_set: RunSet) -> str:
    """The parameters of every hypothesis but the best."""
    rows = [
        ("" if number else readable(one.effects[-1]), effect, *numbers)
        for one in found.contrasts
        for number, (effect, _, *numbers) in enumerate(cause_rows(one.rival, run_set.boat))
    ]
    if not rows:
        return ""
    heads = ("explanation", "effect", *CAUSES[2:])
    return "<p>Parameters of the others:</p>" + table(heads, rows, numbers=(3, 4, 6))


def separating_manoeuvre(found: Diagnosis, run_set: RunSet) -> str:
    """The manoeuvre that separates the hypotheses."""
    trial = found.separating_trial
    if trial is None:
        return ""
    if not separates(found):
        return f"<p>{html.escape(separating_sentence(found).capitalize())}.</p>"
    apart = f"{trial.separation:.1f}" if trial.separation < 100.0 else "100"
    repeat = (
        "needed: repeat it several times" if trial.separation < ENOUGH else "sufficient to distinguish them"
    )
    return (
        "<h2>Separating manoeuvre</h2><p>Of the manoeuvres that this boat can sail: "
        f"<b>{html.escape(manoeuvre_words(trial.manoeuvre))}</b>, "
        f"for {trial.duration_s:.0f} s with the same sensors. The explanation with the lowest χ² would "
        f"then differ by {apart} standard errors or more from each of the others. Three are {repeat}.</p>"
    )


def residual_section(found: Diagnosis, images: Mapping[str, str]) -> str:
    """The residual forces and the variables that they depend on."""
    if found.verdict != "unexplained":
        return ""
    rows = [(force_name(one.force), one.variable, f"{one.explained:.0%}") for one in found.leftover]
    heads = ("residual force", "function of", "variance explained on held-out runs")
    markup = f"<h2>Residual forces</h2><p>{html.escape(rest_sentence(found))}</p>"
    markup += table(heads, rows, numbers=(2,)) if rows else ""
    steps = "".join(f"<li>{html.escape(one[0].upper() + one[1:])}.</li>" for one in found.next_steps)
    markup += f"<p>What to do next:</p><ol>{steps}</ol>" if steps else ""
    if "missing" in images:
        markup += f"<p>{html.escape(shape_sentence(found))}</p>" + image(images["missing"], "Missing force")
    return markup


def gain_section(found: Diagnosis) -> str:
    """Errors without and with the causes on held-out runs."""
    rows = [row for gain in found.gain for row in gain_rows(gain)]
    blocks = sorted({gain.blocks for gain in found.gain if gain.restarts})
    if not is_extended(found):
        rows = [(*row[:3], row[5]) for row in rows]
        heads: tuple[str, ...] = ("seconds ahead (restarts)", "error", "boat file", "unit")
        return "<h2>Prediction errors</h2>" + cards(found) + table(heads, rows, numbers=(0, 2))
    heads = ("seconds ahead (restarts)", "error", "boat file", "extended", REDUCTION, "unit")
    return (
        f"<h2>Prediction errors, boat file and extended boat</h2>{cards(found)}"
        f"<p>Root mean square errors {GAINED_ON[found.gain_on]}. The "
        "interval is that of the paired difference, bootstrapped by "
        f"{' and '.join(blocks)}; where it lies above zero, the reduction is significant. "
        f"<b>{gain_sentence(found)}</b></p>" + table(heads, rows, numbers=(0, 2, 3, 4))
    )


def gain_rows(gain: Gain) -> list[tuple[str, ...]]:
    """One row for each quantity that was measured."""
    rows: list[tuple[str, ...]] = []
    for name in QUANTITIES:
        paired = getattr(gain, name)
        if paired is None:
            continue
        title, unit, factor, _ = SHOWN[name]
        before, after, low, high = (factor * v for v in (paired.before, paired.after, *paired.ci95))
        places = places_of(before)
        shown = (before, after, before - after, low, high)
        cells = [f"{round(value, places) + 0.0:.{places}f}" for value in shown]
        cells[1] = plain(after)  # far below `before`, it would be shown as 0
        span = minus(f"{cells[2]} ({cells[3]} to {cells[4]})")
        ahead = f"{gain.horizon_s:g} ({gain.restarts})" if not rows else ""
        rows.append((ahead, title, cells[0], cells[1], span, unit))
    return rows


def limits_section(found: Diagnosis, run_set: RunSet) -> str:
    """Effects that are not identifiable from the data, and what to record so that they would be."""
    unseen = html.escape(effects_listed(found.unseen, run_set.boat))
    hidden = html.escape(effects_listed(found.hidden, run_set.boat))
    if not unseen and not hidden and not found.missing_motion:
        return ""
    markup = "<h2>Limits of these data</h2>"
    if unseen:
        markup += (
            "<p>Not identifiable from these data, whatever the model (the standard error exceeds a third "
        )
        markup += f"of the effect's typical size): {unseen}.</p>"
    if hidden:
        markup += "<p>Identifiable under the measurement noise, but below the error of this model: "
        markup += f"{hidden}.</p>"
    if found.missing_motion:
        wanted = "".join(f"<li>{html.escape(one)}</li>" for one in found.missing_motion)
        markup += f"<p>Missing in these data, to be recorded next time:</p><ul>{wanted}</ul>"
    return markup


def details(found: Diagnosis, run_set: RunSet) -> str:
    """Measurement noise, and the hypotheses that were fitted."""
    rows = []
    for name in CHANNELS:
        if name in found.noise:
            factor, shown = shown_unit(name)
            level, least = found.noise[name], noise_floor(run_set.boat)[CHANNELS.index(name)]
            below = "below " if level <= least else ""
            rows.append((name.replace("_", " "), below + rounded(factor * max(level, least)), shown))
    tried = [
        (
            readable(c.effect),
            f"{c.held_out_score:.3f}",
            minus(f"{c.gain:.0f}"),
            minus("{:.0f} to {:.0f}".format(*c.gain_ci)),
        )
        for c in found.candidates
    ]
    heads = (
        "hypothesis",
        "χ² an independent sample (noise or model error alone: 1)",
        "reduction [χ²]",
        "95 % interval",
    )
    return (
        "<h2>Details</h2><p>Standard deviations that weight the residuals. The variance is the sum of two: "
        "that of white measurement noise, estimated from third differences of the data, and that of "
        "the error of the simulator's step in whole runs, which may be the larger one. “below”: the estimate "
        "is smaller than the given level, which is used instead.</p>"
        + table(("channel", "standard deviation", "unit"), rows, numbers=(1,))
        + (f"<p>{noise_sentence(found)}</p>" if found.wandering else "")
        + (f"<p>{smoothed_sentence(found)}</p>" if found.smoothed else "")
        + "<details><summary>Hypotheses that were fitted, lowest χ² on held-out runs "
        f"first</summary><p>{CHI2}</p>{table(heads, tried, numbers=(1, 2, 3))}</details>"
        + f'<p class="soft">Found in {found.elapsed_s:.0f} s. <code>diagnosis.json</code> holds every '
        f"number. {html.escape(files_sentence(found))}</p>"
    )


def write_report(folder: Path, finding: Finding, data: str) -> None:
    """Write report.html, self-contained, and its figures as PNG into `folder`; data: what the runs are
    called."""
    paths = {
        "tracks": draw(folder / "tracks.png", finding, draw_tracks),
        "errors": draw(folder / "errors.png", finding, draw_errors),
        "forces": draw(folder / "forces.png", finding, draw_forces),
    }
    if any(one.curve for one in finding.diagnosis.leftover):
        paths["missing"] = draw(folder / "missing.png", finding, draw_missing)
    if finding.next_trial:
        paths["next_trial"] = draw_next_trial(
            folder / "next_trial.png", finding.next_trial, finding.run_set.boat, finding.run_set.dt
        )
    images = {name: base64.b64encode(path.read_bytes()).decode() for name, path in paths.items()}
    text = page(finding.diagnosis, finding.run_set, images, data)
    (folder / "report.html").write_text(text, encoding="utf-8")
