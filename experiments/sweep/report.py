"""What a sweep found: `sweep.json`, a table of it, and a chart of the objective over each parameter."""

import json
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.reports.experiment import rate, table
from swamp_rl.experiments.sweep.over_seeds import over_seeds
from swamp_rl.experiments.sweep.propose import trials_of
from swamp_rl.experiments.sweep.schema import Sweep, override
from swamp_rl.experiments.sweep.store import Trial

from swamp_rl.counted import counted
from swamp_rl.figure_style import sheet
from swamp_rl.files import write_beside

SPREAD = 0.5
"Of the trials with one value of a list, as a share of the way to the next."


def write_report(folder: Path, sweep: Sweep, fixed: Sequence[str], trials: Mapping[int, Trial]) -> None:
    """`sweep.json`, `sweep.md` and `sweep.png` into `folder`.

    fixed: the `key=value` that every trial has. All but `measured` in the JSON is the same whenever the same
    sweep is carried out, wherever and in whatever order.
    """
    found = results(sweep, fixed, trials)
    with write_beside(folder / "sweep.json") as path:
        path.write_text(json.dumps(found, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    with write_beside(folder / "sweep.md") as path:
        path.write_text(_page(sweep, found), encoding="utf-8")
    with write_beside(folder / "sweep.png") as path:
        _draw(path, sweep, trials)


def results(sweep: Sweep, fixed: Sequence[str], trials: Mapping[int, Trial]) -> dict[str, Any]:
    """All of sweep.json."""
    ended = [trials[number] for number in sorted(trials)]
    best = best_of(sweep, ended)
    tried = [
        {"trial": trial.counted, "values": trial.values, "value": trial.value, "summary": trial.summary}
        for trial in ended
    ]
    least = {"least_success": sweep.objective.needed} if _measures(sweep) else {}
    return {
        "name": sweep.name,
        "description": sweep.description,
        "experiment": sweep.experiment,
        "set": list(fixed),
        "objective": sweep.objective.model_dump() | least,
        "planned": trials_of(sweep),
        "failed": sum(trial.error is not None for trial in ended),
        "best": None
        if best is None
        else {"trial": best.counted, "value": best.value, **_again(sweep, fixed, best)},
        "over_seeds": over_seeds(sweep, tried),
        "trials": tried,
        "measured": {
            str(trial.counted): {"seconds": trial.seconds, "attempts": trial.attempts, "error": trial.error}
            for trial in ended
        },
    }


def best_of(sweep: Sweep, trials: Sequence[Trial]) -> Trial | None:
    """The one of the highest rank, the first of equals; None where none has a value."""
    valued = [trial for trial in trials if trial.value is not None]
    rank = sweep.objective.rank
    return max(valued, key=lambda trial: (rank(trial.value, trial.summary), -trial.number), default=None)


def _again(sweep: Sweep, fixed: Sequence[str], trial: Trial) -> dict[str, str]:
    """The command that carries out the whole experiment with a trial's values."""
    keys = [*fixed, *(override(key, value) for key, value in trial.values.items())]
    words = ["swamp-rl", "run", sweep.experiment, *(word for key in keys for word in ("--set", key))]
    return {"again": shlex.join(words)}


def objective_line(sweep: Sweep) -> str:
    """What was swept for, in words."""
    wanted = sweep.objective
    better = "more" if wanted.sign > 0 else "less"
    above = f", from a success of {100.0 * wanted.needed:g} % on" if _measures(sweep) else ""
    return f"{wanted.measure} of {wanted.pilot} at {wanted.level}, {better} is better{above}"


def rows(sweep: Sweep, trials: Sequence[Mapping[str, Any]], measured: Mapping[str, Any]) -> list[list[str]]:
    """Of the table, the best first and those without a value last."""

    def order(trial: Mapping[str, Any]) -> tuple[bool, tuple[bool, float]]:
        return trial["summary"] is not None, sweep.objective.rank(trial["value"], trial["summary"])

    def outcome(trial: Mapping[str, Any]) -> list[str]:
        if trial["summary"] is None:
            cells = ["failed", measured[str(trial["trial"])]["error"]]
            return cells if _measures(sweep) else [": ".join(cells)]
        value = "—" if trial["value"] is None else f"{trial['value']:.4g}"
        return [*(value for _ in _measures(sweep)), rate(trial["summary"])]

    return [
        [str(trial["trial"]), *(str(value) for value in trial["values"].values()), *outcome(trial)]
        for trial in sorted(trials, key=order, reverse=True)
    ]


def _measures(sweep: Sweep) -> list[str]:
    """What the table has a column of beside the success."""
    return [] if sweep.objective.measure == "success" else [sweep.objective.measure]


def _page(sweep: Sweep, found: Mapping[str, Any]) -> str:
    head = ["trial", *sweep.parameters, *_measures(sweep), "success, percent"]
    best = found["best"]
    lines = [
        f"# {sweep.name}: {objective_line(sweep)}",
        *([sweep.description] if sweep.description else []),
        table(head, rows(sweep, found["trials"], found["measured"])),
        f"{len(found['trials'])} of {counted(found['planned'], 'trial')}, {found['failed']} of them failed. "
        "Brackets are Wilson 95 % intervals of one trial; the best of many trials is biased upwards: "
        "evaluate it again with another seed before comparing it.",
        "![the objective over each parameter](sweep.png)",
    ]
    if _measures(sweep):
        lines.insert(-2, _order_line(sweep, found["trials"]))
    if found["over_seeds"]:
        lines.insert(-1, _seeds_table(sweep, found["over_seeds"]))
    if best is not None:
        lines.insert(-1, f"The best, trial {best['trial']}, in full:\n\n```\n{best['again']}\n```")
    return "\n\n".join(lines) + "\n"


def _seeds_table(sweep: Sweep, settings: Sequence[Mapping[str, Any]]) -> str:
    """Means over the seeds, by which settings are to be chosen."""
    what = [*_measures(sweep), "success, percent"]
    head = [*settings[0]["values"], "seeds", *(f"{one}: mean (least to greatest)" for one in what)]
    cells = [
        [
            *(str(value) for value in one["values"].values()),
            str(one["seeds"]),
            *(_spread(one["value"], "{:.4g}", 1.0) for _ in _measures(sweep)),
            _spread(one["success"], "{:.1f}", 100.0),
        ]
        for one in settings
    ]
    return (
        "Over the seeds, the best mean first; the best single trial depends on its seed as well:\n\n"
        + table(head, cells)
    )


def _spread(found: Mapping[str, float] | None, form: str, scale: float) -> str:
    if found is None:
        return "—"
    mean, least, greatest = (form.format(scale * found[key]) for key in ("mean", "least", "greatest"))
    return f"{mean} ({least} to {greatest})"


def _order_line(sweep: Sweep, trials: Sequence[Mapping[str, Any]]) -> str:
    """How trials with too few successes are ordered, and how many there are."""
    wanted = sweep.objective
    measured = [trial for trial in trials if trial["summary"] is not None]
    below = sum(not wanted.rank(trial["value"], trial["summary"])[0] for trial in measured)
    return (
        f"The {wanted.measure} is the mean over successful episodes. Trials of a success below "
        f"{100.0 * wanted.needed:g} % come last, in the order of their success: {below} of {len(measured)}, "
        "open circles."
    )


def _draw(path: Path, sweep: Sweep, trials: Mapping[int, Trial]) -> None:
    """One chart for each parameter, a dot for each trial; success with its interval."""
    valued = [trial for trial in trials.values() if trial.value is not None]
    percent = sweep.objective.measure == "success"
    enough = [sweep.objective.rank(trial.value, trial.summary)[0] for trial in valued]
    colours = ["C0" if one else "white" for one in enough]
    with sheet(path, 3.2 * len(sweep.parameters) + 0.6, 3.0) as figure:
        charts = figure.subplots(1, len(sweep.parameters), sharey=True, squeeze=False)[0]
        for axes, (key, parameter) in zip(charts, sweep.parameters.items(), strict=True):
            listed = parameter.grid or parameter.choice
            values = [trial.values[key] for trial in valued]
            places = values if listed is None else _side_by_side([listed.index(value) for value in values])
            heights = [(100.0 if percent else 1.0) * (trial.value or 0.0) for trial in valued]
            axes.scatter(places, heights, s=16, c=colours, edgecolors="C0", zorder=3)
            if percent:
                ends = [trial.summary["wilson_95"] for trial in valued if trial.summary is not None]
                low, high = 100.0 * np.array(ends).reshape(-1, 2).T
                axes.vlines(places, low, high, lw=1.0, alpha=0.6)
            if listed is not None:
                axes.set_xticks(range(len(listed)), [str(value) for value in listed])
                axes.set_xlim(-0.5, len(listed) - 0.5)
            elif parameter.log_uniform is not None:
                axes.set_xscale("log")
            axes.set_xlabel(key)
        unit = " [%]" if percent else ""
        charts[0].set_ylabel(f"{sweep.objective.measure}{unit}, {sweep.objective.pilot}")


def _side_by_side(places: Sequence[int]) -> list[float]:
    """Those at the same place spread over half the way to the next, in their order."""
    found = []
    for i, place in enumerate(places):
        among, rank = places.count(place), places[:i].count(place)
        found.append(place + SPREAD * ((rank + 0.5) / among - 0.5))
    return found
