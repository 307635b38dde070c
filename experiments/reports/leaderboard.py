"""One page of every pilot in a folder of results: self-contained, sortable, a row for pilot and level."""

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.artifacts.result_folders import (
    Entrant,
    Result,
    entrants,
    find_results,
    plan_of,
    read_result,
)
from swamp_rl.experiments.evaluation.comparison import PER_METRE, pilot_row, quantities_of

from swamp_rl.errors import UserError


@dataclass(frozen=True)
class Row:
    """A pilot at a level; `cells` are text and the number or text to sort by, in the order of `HEADS`."""

    setting: str
    cells: tuple[tuple[str, float | str], ...]


@dataclass(frozen=True)
class Board:
    """All rows, and what could not be read, each in one line."""

    rows: list[Row]
    left_out: list[str]
    folders: int


HEADS = (
    ("pilot", ""),
    ("level", ""),
    ("success [%]", "n"),
    ("95 % interval", "n"),
    ("seeds", "n"),
    ("episodes", "n"),
    ("time [s]", "n"),
    ("change of command [1]", "n"),
    ("energy of the jets [J]", "n"),
    ("electric [J/m]", "n"),
    ("data", ""),
    ("experiment", ""),
    ("commit", ""),
)


def gather(folder: Path, seed: int = 0) -> Board:
    """Every result in `folder`; those of one boat, course and step are ranked with each other.

    A result that cannot be read is left out and named. UserError where there is none at all.
    """
    read, left_out = [], []
    for path in find_results([folder]):
        try:
            read.append(read_result(path))
        except UserError as error:
            left_out.append(str(error))
    if not read:
        raise UserError(f"{folder}: no result in it can be read: {left_out[0]}")
    settings: dict[tuple[tuple[str, str], ...], list[Result]] = {}
    for result in read:
        settings.setdefault(tuple(sorted(result.setting().items())), []).append(result)
    rows: list[Row] = []
    for number, group in enumerate(settings.values(), 1):
        first = group[0].experiment
        title = f"{first.get('boat')} on {first.get('course')}, step {first.get('step')} s"
        if first.get("hidden"):
            title += ", unknown effects in the true boat"
        if len(settings) > 1:
            title += f" (setting {number})"
        rng = np.random.default_rng(seed)
        for entrant in entrants(group):
            rows += _rows(title, entrant, rng)
    return Board(rows, left_out, len(read))


def _rows(title: str, entrant: Entrant, rng: np.random.Generator) -> list[Row]:
    """Of one pilot; each of its training seeds counts by all the episodes that it has driven."""
    shared = [lv for lv in entrant.results[0].levels if all(lv in r.levels for r in entrant.results)]
    rows = []
    for level in shared:
        tables = entrant.tables(level)
        episodes = tables[0]["seed"]
        for table in tables[1:]:
            episodes = np.intersect1d(episodes, table["seed"])
        if not len(episodes):
            continue
        quantities = quantities_of(entrant.results)
        found = pilot_row(entrant, {level: episodes}, rng, quantities)["levels"][level]
        rows.append(Row(title, _cells(entrant, level, found, len(episodes))))
    return rows


def _cells(entrant: Entrant, level: str, found: dict[str, Any], episodes: int) -> tuple[Any, ...]:
    pilot, first = entrant.trained[0]
    rate = found["success"]
    span = "–" if rate["low"] is None else f"{100 * rate['low']:.1f}–{100 * rate['high']:.1f}"
    commits = sorted({str(r.versions.get("commit") or "unknown") for r in entrant.results})
    experiments = sorted({str(r.experiment.get("name")) for r in entrant.results})
    return (
        (entrant.label, entrant.label),
        (level, level),
        (f"{100 * rate['value']:.1f}", rate["value"]),
        (span, rate["low"] if rate["low"] is not None else -1.0),
        (str(len(entrant.results)), len(entrant.results)),
        (str(episodes), episodes),
        *(_number(found.get(cost), form) for cost, form in _COSTS),
        (_data(pilot, first),) * 2,
        (", ".join(experiments),) * 2,
        (", ".join(commits),) * 2,
    )


_COSTS = (("time", "{:.1f}"), ("command_change", "{:.4f}"), ("energy", "{:.0f}"), (PER_METRE, "{:.0f}"))


def _number(value: float | None, form: str) -> tuple[str, float | str]:
    return ("–", "Infinity") if value is None else (form.format(value), value)


def _data(pilot: str, result: Result) -> str:
    """What the pilot learned from, in the words of its results; the source of the runs, if it was runs."""
    learned = _text(result.results, "pilots", pilot, "learned_from")
    source = _text(result.results, "data", "source")
    return f"{source}: {learned}" if source and learned and plan_of(result, pilot).get("data") else learned


def _text(results: Any, *keys: str) -> str:
    """The text that nested keys lead to; empty where there is none."""
    for key in keys:
        results = results.get(key) if isinstance(results, Mapping) else None
    return "" if results is None else str(results)


STYLE = """
:root{--ink:#1c2733;--soft:#5b6874;--line:#dfe4e8;--tint:#f5f7f9;--bar:#cfe0f0}
*{box-sizing:border-box}
body{font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;color:var(--ink);
margin:2rem auto;max-width:90rem;padding:0 1.2rem;background:#fff}
h1{font-size:1.7rem;margin:0 0 .4rem}h2{font-size:1.1rem;margin:2rem 0 .4rem}
p{max-width:60rem;margin:.4rem 0;color:var(--soft)}
.wide{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:.88rem}
th button{all:unset;cursor:pointer;font-weight:600;color:var(--soft)}
th button:hover,th button:focus-visible{color:var(--ink);text-decoration:underline}
th{border-bottom:2px solid var(--line);text-align:left;vertical-align:bottom;padding:.3rem .7rem .3rem 0}
td{border-bottom:1px solid var(--line);padding:.3rem .7rem .3rem 0;vertical-align:top}
.n{text-align:right;font-variant-numeric:tabular-nums}td.n{white-space:nowrap}
td:nth-child(11){min-width:16rem;max-width:24rem;color:var(--soft)}td:first-child{font-weight:600;white-space:nowrap}th:nth-child(11),td:nth-child(11){padding-left:1rem}
tr:hover td{background:var(--tint)}
[aria-sort=ascending] button::after{content:" ▲"}[aria-sort=descending] button::after{content:" ▼"}
"""

SCRIPT = """
for (const button of document.querySelectorAll("th button")) button.addEventListener("click", () => {
  const th = button.closest("th"), table = th.closest("table"), body = table.tBodies[0];
  const column = th.cellIndex, number = th.classList.contains("n");
  const down = th.getAttribute("aria-sort") ? th.getAttribute("aria-sort") === "ascending" : number;
  for (const other of table.querySelectorAll("th")) other.removeAttribute("aria-sort");
  th.setAttribute("aria-sort", down ? "descending" : "ascending");
  const key = row => row.cells[column].dataset.key;
  const order = number ? (a, b) => Number(key(a)) - Number(key(b)) : (a, b) => key(a).localeCompare(key(b));
  [...body.rows].sort((a, b) => (down ? -1 : 1) * order(a, b)).forEach(row => body.append(row));
});
"""


def page(board: Board, mark: str = "") -> str:
    """The page as HTML; nothing in it is loaded from elsewhere, and every name is text.

    mark: by which it is known later.
    """
    parts = [
        "<h1>Leaderboard</h1><p>One row for each pilot at each level of disturbance. With one training seed "
        "the interval is Wilson's, over the episodes of that one trained pilot; with several, success is the "
        "interquartile mean over them, the interval of seeds (bootstrap) and episodes (Wilson). Costs are "
        "means over the successful episodes. Click a heading to sort.</p>"
    ]
    for title in dict.fromkeys(row.setting for row in board.rows):
        rows = [row for row in board.rows if row.setting == title]
        parts.append(f"<h2>{html.escape(title)}</h2>{_table(rows)}")
    if board.left_out:
        lines = "".join(f"<li>{html.escape(line)}</li>" for line in board.left_out)
        parts.append(f"<h2>Left out</h2><ul>{lines}</ul>")
    head = f'<meta charset="utf-8"><meta name="generator" content="{mark}">'
    head += '<meta name="viewport" content="width=device-width">'
    head += f"<title>Leaderboard</title><style>{STYLE}</style>"
    body = "".join(parts) + f"<script>{SCRIPT}</script>"
    return f'<!doctype html><html lang="en"><head>{head}</head><body>{body}</body></html>\n'


def _table(rows: Sequence[Row]) -> str:
    """Levels in their order, the best of each first."""
    levels = list(dict.fromkeys(row.cells[1][0] for row in rows))
    best = sorted(rows, key=lambda row: (levels.index(row.cells[1][0]), -float(row.cells[2][1])))
    top = "".join(
        f'<th class="{kind}"><button type="button">{html.escape(head)}</button></th>' for head, kind in HEADS
    )
    body = "".join(f"<tr>{''.join(_cell(*pair) for pair in _kinds(row))}</tr>" for row in best)
    return f'<div class="wide"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'


def _kinds(row: Row) -> list[tuple[str, str, float | str]]:
    return [(kind, text, key) for (_, kind), (text, key) in zip(HEADS, row.cells, strict=True)]


def _cell(kind: str, text: str, key: float | str) -> str:
    return f'<td class="{kind}" data-key="{html.escape(str(key))}">{html.escape(text)}</td>'
