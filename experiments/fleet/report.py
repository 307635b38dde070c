"""The report of a fleet as one HTML page."""

import html
import sys
from collections.abc import Collection
from urllib.parse import quote

from swamp_rl.experiments.fleet.result import Fleet, Member
from swamp_rl.experiments.fleet.words import (
    cause_words,
    causes_of_boat,
    drift_values,
    effect_words,
    equivalents,
    listed,
    not_kept,
    warning_sentence,
    weather_sentence,
    weather_words,
)

from swamp_rl.counted import counted
from swamp_rl.criticism.report.words import in_degrees
from swamp_rl.html_page import document, minus, plain, prose, table


def page(fleet: Fleet) -> str:
    """The whole page."""
    parts = [_opening(fleet), _boats(fleet), _members(fleet), _shared(fleet), _drifts(fleet)]
    return document("Diagnosis of a fleet", [*parts, _findings(fleet)])


def _opening(fleet: Fleet) -> str:
    boats = len({one.boat for one in fleet.members})
    failed = sum(one.verdict is None for one in fleet.members)
    kept = sum(one.kept for one in fleet.findings)
    lacking = f"{counted(failed, 'dataset')} could not be" if failed else "All datasets were"
    warning = warning_sentence(fleet)
    return (
        f"<h1>{counted(len(fleet.members), 'dataset')} of {counted(boats, 'boat')}</h1>"
        f"<p>{kept} of {len(fleet.findings)} causes, the weather's among them, are kept at a false discovery "
        f"rate of {fleet.rate:.0%} (Benjamini and Hochberg, {counted(fleet.tests, 'test')}). "
        f"{lacking} diagnosed.</p>" + (f"<p><b>{prose(warning)}</b></p>" if warning else "")
    )


def _boats(fleet: Fleet) -> str:
    rows = [(one.boat, causes_of_boat(one, fleet) or "none", listed(one.lesser)) for one in fleet.boats]
    heads = ("boat", "causes of its own, kept in a dataset", "only minor, or not kept")
    note = ""
    if fleet.weather:
        note = f'<p class="soft">{html.escape(weather_sentence(fleet))}</p>'
    return "<h2>Boats</h2>" + table(heads, rows) + note


def _members(fleet: Fleet) -> str:
    refused = not_kept(fleet)
    horizons = {one.position_error.horizon_s for one in fleet.members if one.position_error}
    ahead = f"{horizons.copy().pop():g} s ahead" if len(horizons) == 1 else "ahead"
    rows = [_row(one, refused, len(horizons) == 1) for one in fleet.members]
    heads = (
        "dataset",
        "boat",
        "verdict",
        "causes of the boat ± one standard error, or why there is no diagnosis",
        "weather",
        f"position error {ahead} [m]: boat file → extended boat",
    )
    note = (
        '<p class="soft">A verdict is unexplained where the residuals exceed the noise even with all causes, '
        "which are significant nevertheless. Minor causes are below 2 % of every prediction error, below the "
        "noise, or within the errors of the boat file. Position errors are root mean squares on held-out "
        "runs.</p>"
    )
    return "<h2>Datasets</h2>" + table(heads, rows, raw=True, unbroken=(0, 5)) + note


def _row(one: Member, refused: Collection[tuple[str, str]], same_horizon: bool) -> tuple[str, ...]:
    name, report = html.escape(one.name), f"./{quote(one.name)}/report.html"
    if one.verdict is None:
        return name, html.escape(one.boat), "not diagnosed", html.escape(one.error or ""), "", ""
    weather = ", ".join(weather_words(each) for each in one.causes if each.weather)
    ahead = ""
    if error := one.position_error:
        ahead = f"{plain(error.before)} → {plain(error.after)}"
        ahead += "" if same_horizon else f" ({error.horizon_s:g} s)"
    return (
        f'<a href="{report}">{name}</a>',
        html.escape(one.boat),
        one.verdict.replace("_", " "),
        _causes(one, refused),
        html.escape(weather),
        ahead,
    )


def _causes(one: Member, refused: Collection[tuple[str, str]]) -> str:
    """The boat's causes, a line each, then minor ones and what cannot be distinguished."""
    own = [each for each in one.causes if not each.weather]
    lines = [
        html.escape(cause_words(each) + (" (not kept)" if (one.name, each.cause) in refused else ""))
        for each in own
    ]
    rest = [f"minor: {cause_words(each)}" for each in one.minor if not each.weather]
    rest += [f"cannot be distinguished: {equivalents(each)}" for each in one.indistinguishable]
    lines += [f'<span class="soft">{html.escape(each)}</span>' for each in rest]
    return "<br>".join(lines if own else ["none", *lines])


def _p(value: float) -> str:
    """A p-value; one below the least number is written as such."""
    return f"{value:.2g}" if value else f"< {sys.float_info.min:.0e}"


def _shared(fleet: Fleet) -> str:
    rows = [
        (
            effect_words(one.cause),
            f"{len(one.boats)} of {len(fleet.boats)}",
            ", ".join(one.boats),
            "an error of the common boat file" if one.in_boat_file else "",
        )
        for one in fleet.shared
    ]
    note = ""
    if any(one.in_boat_file for one in fleet.shared):
        note = (
            "<p>All boats were compared with the same numbers, whose errors they all have. A cause that most "
            "of them share is likely such an error: correct the boat file, "
            "<code>swamp-rl identify boat</code>, and repeat the fleet.</p>"
        )
    heads = ("cause", "boats", "names", "likely")
    return "<h2>Causes that several boats have</h2>" + table(heads, rows, numbers=(1,)) + note


def _drifts(fleet: Fleet) -> str:
    rows = []
    for one in fleet.drifts:
        _, unit = in_degrees(one.unit)
        values = "; ".join(f"{name} {minus(value)}" for name, value in drift_values(one))
        cause = effect_words(one.cause)
        rows.append((one.boat, cause, one.parameter.replace("_", " "), unit, values, _p(one.p)))
    heads = ("boat", "cause", "parameter", "unit", "values ± one standard error", "p")
    changed = [
        (one.boat, effect_words(one.cause), ", ".join(one.found_in), ", ".join(one.absent_in))
        for one in fleet.changes
    ]
    return (
        "<h2>What differs between the datasets of one boat</h2>"
        + table(heads, rows, numbers=(5,))
        + "<h2>Causes found in some datasets of a boat only</h2>"
        + table(("boat", "cause", "found in", "not found in"), changed)
    )


def _findings(fleet: Fleet) -> str:
    rows = [
        (one.name, effect_words(one.cause), _p(one.p), "yes" if one.kept else "no") for one in fleet.findings
    ]
    return "<h2>Causes and their p-values</h2>" + table(("dataset", "cause", "p", "kept"), rows, numbers=(2,))
