"""What the causes account for, and what the boat file is compared with: sentences and tables."""

import html

from swamp_rl.criticism.likelihood.prediction_error import TRIVIAL, NoBetter, no_better
from swamp_rl.criticism.options import options
from swamp_rl.criticism.report.figures import SHOWN
from swamp_rl.criticism.report.words import of_boat, readable, shown_unit
from swamp_rl.criticism.result import Cause, Diagnosis, Share
from swamp_rl.html_page import minus

PLAIN = ("nothing", "unexplained")  # answers of a self-trial that are no effects


def predictors_sentence(found: Diagnosis) -> str:
    """Where the boat file predicts no better than a trivial predictor; empty if it is better everywhere."""
    behind = no_better(found.predictors)
    if behind is None:
        return ""
    better = _is_below(found, behind)
    parts = [f"The boat file predicts {behind.words}."]
    parts += ["The extended boat predicts better than both."] * better
    if not better or found.verdict != "cause":
        parts += ["If its numbers are guesses, fit them before reading causes: swamp-rl identify boat."]
    return " ".join(parts)


def _is_below(found: Diagnosis, behind: NoBetter) -> bool:
    """Whether the extended boat's position error at a horizon is below a trivial predictor's."""
    gains = [one.position_rmse_m for one in found.gain if one.horizon_s == behind.horizon_s]
    return any(one is not None and one.after < behind.trivial for one in gains)


def predictor_rows(found: Diagnosis) -> list[tuple[str, ...]]:
    """Position errors [m] of the boat file and the trivial predictors, a row a horizon."""
    return [
        (f"{one.horizon_s:g}", f"{one.boat_file:.3g}", *(f"{getattr(one, name):.3g}" for name in TRIVIAL))
        for one in found.predictors
    ]


def carry_over_sentence(found: Diagnosis) -> str:
    """Effects that make a position error on held-out runs larger."""
    parts = []
    for cause in (*found.causes, *found.minor, *found.nuisance):
        if cause.carries_over:
            continue
        positions = [one for one in cause.share if one.quantity == "position_rmse_m"]
        worst = min(positions, key=lambda one: one.ci95[1])
        measured = " in the measured wind" if worst.wind == "measured" else ""
        why = (
            f"{worst.horizon_s:g} s ahead on held-out runs the position error{measured} is "
            f"{worst.with_cause:.3g} m with it and {worst.without:.3g} m without"
        )
        if worst.ci95[1] >= 0.0:
            why = "with all effects the position error on held-out runs is larger than the boat file's"
        label = readable(cause.label)
        parts.append(
            f"{label[0].upper()}{label[1:]} does not carry over: {why}. It is not in the extended file."
        )
    return " ".join(parts)


def minor_sentence(found: Diagnosis) -> str:
    """The minor causes, by why they are."""
    parts = []
    for within, text in (
        (
            False,
            "Significant, but minor: {} (below the noise, and below 2 % of every prediction error "
            "or by chance).",
        ),
        (True, "Within the standard errors of the boat file's fitted numbers: {}."),
    ):
        labels = [cause.label for cause in found.minor if cause.within_boat_errors == within]
        parts += [text.format(readable(" + ".join(labels)))] if labels else []
    return " ".join(parts)


def smoothed_sentence(found: Diagnosis) -> str:
    """The channels that a filter smoothed before they were logged."""
    if not found.smoothed:
        return ""
    parts = []
    for name, one in found.smoothed.items():
        factor, shown = shown_unit(name)
        parts.append(
            f"{name.replace('_', ' ')} {factor * one.sample_noise:.2g} {shown}, weighted with "
            f"{factor * one.standard_deviation:.2g} {shown} (time constant {one.time_constant_s:.2g} s)"
        )
    return (
        "A filter smoothed channels before they were logged: their noise is correlated from row to row and "
        "larger at low frequencies than at the sample rate. Standard deviation at the sample rate: "
        f"{'; '.join(parts)}. Log the unfiltered sensor for smaller standard errors."
    )


def share_rows(causes: list[Cause]) -> list[tuple[str, ...]]:
    """Errors without and with each cause, its share, its reduction with 95 % interval, and how far it moves
    the prediction.
    """
    return [
        ("" if number else readable(cause.label), *_share_cells(one))
        for cause in causes
        for number, one in enumerate(cause.share)
    ]


def share_text(cause: Cause, found: Diagnosis) -> str:
    """The share of the position error at the longest horizon, and where that is none, by how much the cause
    moves the prediction. Where none was measured it is empty, unless the cause is weather that was not
    applied to held-out runs.
    """
    positions = [one for one in cause.share if one.quantity == "position_rmse_m" and one.wind == "fitted"]
    if not positions:
        apart = not of_boat(cause) and found.gain_on == "other_runs"
        judged = any(one.position_rmse_m for one in found.gain if one.horizon_s in options().judged_horizons)
        return "not applied to the held-out runs, which may be of another day" if apart and judged else ""
    one = positions[-1]
    errors = f"{one.without:.3g} m without it, {one.with_cause:.3g} m with it"
    if one.with_cause < one.without:
        return f"{percent(one)} of the position error {one.horizon_s:g} s ahead ({errors})"
    moved = "" if one.moved is None else f"; it moves the prediction by {one.moved:.3g} m"
    return f"no share of the position error {one.horizon_s:g} s ahead ({errors}){moved}"


def percent(one: Share) -> str:
    """The share of the error without a cause that it accounts for."""
    return minus(f"{100.0 * (one.without - one.with_cause) / one.without:.0f} %")


def _share_cells(one: Share) -> tuple[str, ...]:
    quantity, unit, scale, _ = SHOWN[one.quantity]
    less, low, high = (scale * end for end in (one.without - one.with_cause, *one.ci95))
    return (
        f"{quantity}, {one.horizon_s:g} s" + (", measured wind" if one.wind == "measured" else ""),
        f"{scale * one.without:.3g}",
        f"{scale * one.with_cause:.3g}",
        percent(one),
        minus(f"{less:.3g} ({low:.3g} to {high:.3g})"),
        "" if one.moved is None else f"{scale * one.moved:.3g}",
        unit,
    )


def self_trial_sentence(found: Diagnosis) -> str:
    """How often twins of the answer are diagnosed alike; empty where there was no self-trial."""
    trial = found.self_trial
    if trial is None:
        return ""
    if trial.omitted is not None:
        return f"No self-trial: {trial.omitted[0].lower()}{trial.omitted[1:]}"
    own = "diagnosed as nothing wrong" if found.verdict == "nothing_wrong" else "named"
    times = {1: "once", 2: "twice"}
    others = [
        f"{times.get(count, f'{count} times')} {label if label in PLAIN else readable(label)} instead"
        for label, count in trial.confused_with.items()
    ]
    return f"{'; '.join([f'Self-trial: {own} {trial.named} of {trial.of} times', *others])}."


def self_trial_section(found: Diagnosis) -> str:
    """The section of the page; empty where there was no self-trial."""
    if found.self_trial is None:
        return ""
    how = "by a full search."
    if found.self_trial.method == "linearised":
        how = "without a new search: this answer and its alternatives are compared by the criterion, "
        how += "linearised about noise-free fits."
    note = ""
    if not found.self_trial.omitted:
        note = (
            "<p>Twins are runs simulated from this answer with the same commands, lengths, sampling and "
            f"estimated noise. Each twin is diagnosed again from the boat file, {how} The rate estimates how "
            "often an answer of this size would be found again, if it is true.</p>"
        )
    return f"<h2>Self-trial</h2><p><b>{html.escape(self_trial_sentence(found))}</b></p>{note}"
