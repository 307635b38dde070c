"""The report of a fleet as one HTML page."""

import html
import sys
from urllib.parse import quote

from swamp_rl.experiments.fleet.result import Fleet

from swamp_rl.counted import counted
from swamp_rl.digits import digits, known
from swamp_rl.html_page import document, minus, table


def page(fleet: Fleet) -> str:
    """The whole page."""
    parts = [_opening(fleet), _shared(fleet), _drifts(fleet), _members(fleet), _findings(fleet)]
    return document("Diagnosis of a fleet", parts)


def _opening(fleet: Fleet) -> str:
    boats = len({one.boat for one in fleet.members})
    failed = sum(one.verdict is None for one in fleet.members)
    kept = sum(one.kept for one in fleet.findings)
    lacking = f"{counted(failed, 'dataset')} could not be" if failed else "All datasets were"
    return (
        f"<h1>{counted(len(fleet.members), 'dataset')} of {counted(boats, 'boat')}</h1>"
        f"<p>{kept} of {len(fleet.findings)} causes are kept at a false discovery rate of {fleet.rate:.0%} "
        f"(Benjamini and Hochberg, {counted(fleet.tests, 'test')}). "
        f"{lacking} diagnosed.</p>"
    )


def _p(value: float) -> str:
    """A p-value; one below the least number is written as such."""
    return f"{value:.2g}" if value else f"< {sys.float_info.min:.0e}"


def _shared(fleet: Fleet) -> str:
    rows = [(one.cause, str(len(one.boats)), ", ".join(one.boats)) for one in fleet.shared]
    parts = "<h2>Causes that several boats have</h2>" + table(("cause", "boats", "names"), rows, numbers=(1,))
    if fleet.weather:
        parts += f'<p class="soft">{html.escape(weather_sentence(fleet))}</p>'
    return parts


def weather_sentence(fleet: Fleet) -> str:
    """The weather of the runs, which is no cause of a boat's."""
    listed = (f"{one.cause.replace('_', ' ')} ({', '.join(one.boats)})" for one in fleet.weather)
    return f"Weather, which is not the boats' and is left out here: {'; '.join(listed)}."


def _drifts(fleet: Fleet) -> str:
    rows = []
    for one in fleet.drifts:
        values = "; ".join(
            minus(f"{name} {known(value, error, 6)} ± {digits(error, 2)}")
            for name, value in one.values.items()
            for error in (one.standard_errors[name],)
        )
        rows.append((one.boat, one.cause, one.parameter.replace("_", " "), one.unit, values, _p(one.p)))
    heads = ("boat", "cause", "parameter", "unit", "values ± one standard error", "p")
    changed = [
        (one.boat, one.cause, ", ".join(one.found_in), ", ".join(one.absent_in)) for one in fleet.changes
    ]
    return (
        "<h2>What differs between the datasets of one boat</h2>"
        + table(heads, rows, numbers=(5,))
        + "<h2>Causes found in some datasets of a boat only</h2>"
        + table(("boat", "cause", "found in", "not found in"), changed)
    )


def _members(fleet: Fleet) -> str:
    rows = []
    for one in fleet.members:
        name, report = html.escape(one.name), f"./{quote(one.name)}/report.html"
        link = f'<a href="{report}">{name}</a>' if one.verdict else name
        verdict = one.verdict.replace("_", " ") if one.verdict else "not diagnosed"
        cell = one.error or ", ".join(one.causes)
        rows.append((link, html.escape(one.boat), verdict, html.escape(cell)))
    heads = ("dataset", "boat", "verdict", "causes, or why there is no diagnosis")
    return "<h2>Datasets</h2>" + table(heads, rows, raw=True)


def _findings(fleet: Fleet) -> str:
    rows = [(one.name, one.cause, _p(one.p), "yes" if one.kept else "no") for one in fleet.findings]
    return "<h2>Causes and their p-values</h2>" + table(("dataset", "cause", "p", "kept"), rows, numbers=(2,))
