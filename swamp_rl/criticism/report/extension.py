"""The force that no named effect explains, in words: what was written, and what it saves."""

import html

from swamp_rl.boat import Boat
from swamp_rl.criticism.data.command_names import COMMANDS, as_column
from swamp_rl.criticism.report.evidence import percent
from swamp_rl.criticism.report.words import readable
from swamp_rl.criticism.result import Diagnosis, ForceCurve
from swamp_rl.effects.curve import COVARIATES
from swamp_rl.html_page import minus, rounded, table

FORMULAS = {
    "proportional": "a x",
    "square": "a |x| x",
    "cube": "a x³",
    "dead_zone": "a sign(x) max(|x| − b, 0)",
    "outside_radius": "a sign(x) where |x| > b",
    "sine": "a sin(x − b)",
}


def curve_name(curve: ForceCurve, boat: Boat) -> str:
    """`north force as a function of position north [m]`."""
    force = f"thrust of {curve.thruster}" if curve.component == "thrust" else f"{curve.component} force"
    if curve.component == "yaw":
        force = "yaw moment"
    return f"{force} as a function of {variable_of(curve, boat)}"


def variable_of(curve: ForceCurve, boat: Boat) -> str:
    """What a force depends on, with its unit; commands as `as_column` names them."""
    name = curve.covariate.replace("_", " ")
    if curve.covariate in COMMANDS:
        name = as_column(f"{name} {curve.thruster}", boat)
    return f"{name} [{COVARIATES[curve.covariate]}]"


def extension_sentence(found: Diagnosis, boat: Boat) -> str:
    """What of the missing force is in extended_boat.yaml, or why it is not; empty where there is none."""
    extension = found.extension
    if extension is None:
        return ""
    names = " and ".join(curve_name(curve, boat) for curve in extension.curves)
    if not extension.written:
        return (
            f"The missing force is {names}, but its reduction of the prediction error on held-out runs is "
            "not significant: it is not written to extended_boat.yaml."
        )
    instead = [one.label for one in found.causes if one.carries_over and one not in found.standing]
    of = readable(" + ".join(instead)) if instead else ""
    apart = f" It was fitted in place of {of}, which that file lacks." if instead else ""
    by = ", ".join(dict.fromkeys(curve.formula or "linear between points" for curve in extension.curves))
    saved = max(
        (one for one in extension.share if one.quantity == "position_rmse_m"), key=lambda one: one.ci95[0]
    )
    return (
        f"extended_boat.yaml has the missing force ({by}): {names}.{apart} On held-out runs it accounts for "
        f"{percent(saved)} of the position error {saved.horizon_s:g} s ahead ({saved.without:.3g} m without "
        f"it, {saved.with_cause:.3g} m with it). The cause is unknown. Outside the range of the data the "
        "force is zero."
    )


def extension_section(found: Diagnosis, boat: Boat) -> str:
    """The missing force as a table of its values; empty where there is none."""
    if found.extension is None:
        return ""
    parts = [f"<h2>The missing force as an effect</h2><p>{html.escape(extension_sentence(found, boat))}</p>"]
    for curve in found.extension.curves:
        name = html.escape(curve_name(curve, boat))
        units = curve.units if curve.formula else curve.units * len(curve.values)
        if curve.formula:
            ends = " to ".join(minus(rounded(end)) for end in curve.knots)
            parts.append(f"<p>{name}: {FORMULAS[curve.formula]}, x from {ends}</p>")
            labels = ["a", "b"][: len(curve.values)]
            heads: tuple[str, ...] = ("coefficient", "value", "standard error", "unit")
        else:
            parts.append(f"<p>{name}</p>")
            labels = [minus(rounded(knot)) for knot in curve.knots]
            heads = (variable_of(curve, boat), "force", "standard error", "unit")
        every = zip(labels, curve.values, curve.standard_errors, units, strict=True)
        rows = [(label, minus(rounded(value)), rounded(error), unit) for label, value, error, unit in every]
        parts.append(table(heads, rows, numbers=(1, 2)))
    return "".join(parts)
