"""What the causes account for, and what the boat file is compared with: sentences and tables."""

import math

from swamp_rl.criticism.report.words import label_of, minus, readable, shown_unit
from swamp_rl.criticism.result import Cause, Diagnosis, Predictors, Share

TRIVIAL = {
    "at_rest": "a boat that stays where it is",
    "constant_velocity": "constant velocity",
    "no_thrust": "the same boat without thrust",
}
FROM = 5.0  # s, below which every predictor that starts from the measured state is good
SCALES = {
    "position_rmse_m": (1.0, "m", "position"),
    "heading_rmse_rad": (180.0 / math.pi, "degrees", "heading"),
}


def as_good(one: Predictors) -> list[str]:
    """Trivial predictors that predict positions no worse than the boat file."""
    return [name for name in TRIVIAL if getattr(one, name) <= one.boat_file]


def predictors_sentence(found: Diagnosis) -> str:
    """Where the boat file predicts no better than a trivial predictor; empty if it is better everywhere."""
    for one in found.predictors:
        if one.horizon_s >= FROM and (names := as_good(one)):
            best = min(names, key=lambda name: float(getattr(one, name)))
            advice = " Fit its numbers before reading causes: swamp-rl identify boat."
            if _explained(found, one.horizon_s, getattr(one, best)):
                advice = " The extended boat predicts better than both."
            return (
                f"The boat file predicts positions {one.horizon_s:g} s ahead no better than {TRIVIAL[best]}: "
                f"{one.boat_file:.3g} m against {getattr(one, best):.3g} m.{advice}"
            )
    return ""


def _explained(found: Diagnosis, horizon: float, trivial: float) -> bool:
    """Whether the causes alone bring the position error at a horizon below a trivial predictor's."""
    gains = [one.position_rmse_m for one in found.gain if one.horizon_s == horizon]
    return found.verdict == "cause" and any(one is not None and one.after < trivial for one in gains)


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
        worst = min(
            (one for one in cause.share if one.quantity == "position_rmse_m"), key=lambda one: one.ci95[1]
        )
        if worst.ci95[1] >= 0.0:
            parts.append(
                f"{readable(label_of(cause))} does not carry over: with all effects the position error on "
                "held-out runs is larger than the boat file's. It is written to no file."
            )
            continue
        measured = " in the measured wind" if worst.wind == "measured" else ""
        parts.append(
            f"{readable(label_of(cause))} does not carry over: {worst.horizon_s:g} s ahead on held-out runs "
            f"the position error{measured} is {worst.with_cause:.3g} m with it and {worst.without:.3g} m "
            "without. It is written to no file."
        )
    return " ".join(parts)


def minor_sentence(found: Diagnosis) -> str:
    """The minor causes."""
    if not found.minor:
        return ""
    names = readable(" + ".join(label_of(cause) for cause in found.minor))
    return f"Significant, but minor: {names} (below 2 % of every prediction error and below the noise)."


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
    """Errors without and with each cause, the share that it accounts for and its 95 % interval."""
    rows: list[tuple[str, ...]] = []
    for cause in causes:
        name = readable(label_of(cause))
        for one in cause.share:
            rows.append((name, *_share_cells(one)))
            name = ""
    return rows


def share_text(cause: Cause) -> str:
    """The share of the position error at the longest horizon; empty where none was measured."""
    positions = [one for one in cause.share if one.quantity == "position_rmse_m" and one.wind == "fitted"]
    if not positions:
        return ""
    one = positions[-1]
    return (
        f"{percent(one)} of the position error {one.horizon_s:g} s ahead "
        f"({one.without:.3g} m without it, {one.with_cause:.3g} m with it)"
    )


def percent(one: Share) -> str:
    """The share of the error without a cause that it accounts for."""
    return f"{100.0 * (one.without - one.with_cause) / one.without:.0f} %"


def _share_cells(one: Share) -> tuple[str, ...]:
    scale, unit, quantity = SCALES[one.quantity]
    less, low, high = (scale * end for end in (one.without - one.with_cause, *one.ci95))
    return (
        f"{quantity}, {one.horizon_s:g} s" + (", measured wind" if one.wind == "measured" else ""),
        f"{scale * one.without:.3g}",
        f"{scale * one.with_cause:.3g}",
        percent(one),
        minus(f"{less:.3g} ({low:.3g} to {high:.3g})"),
        unit,
    )
