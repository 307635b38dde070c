"""The report of an experiment: `results.json` as text, tables and figures."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from swamp_rl.counted import counted
from swamp_rl.evaluation import COSTS, ELECTRIC

Results = Mapping[str, Any]

COST_NAMES = {
    "time": ("time [s]", "{:.1f}"),
    "path_length": ("path [m]", "{:.1f}"),
    "command_change": ("change of command per step [1]", "{:.4f}"),
    "energy": ("energy of the jets [J]", "{:.0f}"),
    "electric_energy": ("electric energy [J]", "{:.0f}"),
    "energy_per_metre": ("electric [J/m]", "{:.0f}"),
    "range": ("range left [m]", "{:.0f}"),
}
TARGETS: dict[str, tuple[str, Callable[[float], str]]] = {
    "success": ("success at least {}", lambda rate: f"{100 * rate:.1f} %"),
    "smoothness": ("change of command below the data's {}", lambda change: f"{change:.4f}"),
}


def report(results: Results) -> str:
    """The report as Markdown; its pictures lie in `figures/` beside it."""
    parts = [
        _opening,
        success,
        failures,
        _returns,
        _targets,
        training_data,
        _tracks,
        _commands,
        _costs,
        _differences,
        _again,
    ]
    return "\n\n".join(part(results) for part in parts) + "\n"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table, first column to the left, the others to the right."""
    lines = [head, [":--", *["--:"] * (len(head) - 1)], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def titled(title: str, description: str) -> str:
    """The head of a Markdown report, before its first paragraph; without a description none of its lines."""
    return "".join(f"{part}\n\n" for part in (f"# {title}", description) if part)


def rate(summary: Mapping[str, Any]) -> str:
    """A success rate with its interval, in percent."""
    low, high = summary["wilson_95"]
    return f"{100 * summary['success_rate']:.1f} ({100 * low:.1f}–{100 * high:.1f})"


def _levels(results: Results) -> list[str]:
    return list(results["evaluation"]["levels"])


def _opening(results: Results) -> str:
    data = results["data"]
    return (
        f"# {results['name']}: success and costs of the pilots\n\n"
        f"Boat `{results['boat']}` on the course `{results['course']}`. {_use(data)}: "
        f"{counted(data['successful'], 'successful run')} ({data['source']}, {data['minutes']:.1f} min). "
        f"Every pilot was evaluated in the same {results['evaluation']['episodes']} seeded episodes at each "
        f"level of disturbance. **{targets_reached(results['targets'])}**"
    )


def _use(data: Mapping[str, Any]) -> str:
    """What the runs are to the pilots: all of these may have been trained elsewhere, on other runs."""
    return "Training data" if data["trained_on"] else "Runs for comparison"


def targets_reached(targets: Sequence[Mapping[str, Any]]) -> str:
    """How many of an experiment's targets were reached, as a sentence."""
    if not targets:
        return "The experiment sets no targets."
    return f"Targets reached: {sum(target['reached'] for target in targets)} of {len(targets)}."


def _by_level(results: Results, cell: Callable[[Mapping[str, Any]], str]) -> str:
    """A row for each pilot, a column for each level, `cell` of the pilot's summary there."""
    rows = [
        [name, *(cell(pilot["levels"][level]) for level in _levels(results))]
        for name, pilot in results["pilots"].items()
    ]
    return table(["pilot", *_levels(results)], rows)


def success(results: Results) -> str:
    """Success rates by pilot and level, and what counts as success."""
    return (
        "## Success rate\n\n"
        "All gates passed in their order and direction, no buoy and no ground touched, within the bounds and "
        "the time limit. Percent, with Wilson's 95 % interval.\n\n"
        + _by_level(results, rate)
        + "\n\n![Success rates](figures/success.png)"
    )


def failures(results: Results) -> str:
    """How the episodes ended that did not succeed, by pilot and level."""
    return (
        "## Failures\n\nOutcomes of the other episodes: a buoy touched, out of bounds, aground, or the time "
        "limit reached.\n\n" + _by_level(results, _ended)
    )


def _ended(summary: Mapping[str, Any]) -> str:
    counts = {how: n for how, n in summary["outcomes"].items() if how != "success"}
    by_count = sorted(counts.items(), key=lambda item: -item[1])
    return ", ".join(f"{n} {how.replace('_', ' ')}" for how, n in by_count) or "none"


def _returns(results: Results) -> str:
    return (
        "## Return\n\n"
        "Mean over all episodes of the sum of the rewards, with its 95 % interval. `config/experiment.yaml` "
        "has the weights of the reward.\n\n" + _by_level(results, _mean_return)
    )


def _mean_return(summary: Mapping[str, Any]) -> str:
    if summary.get("return_95") is None:
        return "–" if "mean_return" not in summary else f"{summary['mean_return']:.2f}"
    low, high = summary["return_95"]
    return f"{summary['mean_return']:.2f} ({low:.2f} to {high:.2f})"


def _targets(results: Results) -> str:
    if not results["targets"]:
        return "## Targets\n\nNone."
    rows = []
    for target in results["targets"]:
        asked, form = TARGETS[target["what"]]
        measured = "no success" if target["measured"] is None else form(target["measured"])
        needed = asked.format(form(target["needed"]))
        verdict = "reached" if target["reached"] else "**not reached**"
        rows.append([f"{target['pilot']}, {target['level']}", needed, measured, verdict])
    return "## Targets\n\n" + table(["pilot, level", "needed", "measured", "target"], rows)


def _made_for(pilot: Mapping[str, Any]) -> str:
    return f", made for {pilot['made_for']}" if pilot.get("made_for") else ""


def _fitted_on(pilot: Mapping[str, Any]) -> str:
    runs = pilot.get("fitted_on")
    return f", trained on {counted(runs['runs'], 'run')} ({runs['source']})" if runs else ""


def training_data(results: Results) -> str:
    """The runs, how they ended, and which of them each pilot learned from."""
    data = results["data"]
    learners = [
        f"* **{name}**: {pilot['learned_from']}{_fitted_on(pilot)}{_made_for(pilot)}"
        for name, pilot in results["pilots"].items()
        if pilot["learned_from"]
    ]
    others = _ended(data)
    return (
        f"## {_use(data)}\n\n"
        f"{counted(data['runs'], 'run')}, {data['successful']} of them successful; outcomes of the others: "
        f"{others}. These are kept and marked; a pilot is trained on them only where this list says so.\n\n"
        + "\n".join(learners)
        + "".join(f"\n* Note: {line}" for line in data["notes"])
        + "\n\n![Tracks of these runs](figures/training_tracks.png)"
    )


def _tracks(results: Results) -> str:
    return (
        "## Tracks\n\n"
        f"The first {results['evaluation']['shown']} episodes of each pilot at each level.\n\n"
        "![Tracks](figures/tracks.png)"
    )


def _commands(results: Results) -> str:
    data, levels = results["data"], _levels(results)
    rows = []
    for name, pilot in results["pilots"].items():
        changes = [pilot["levels"][level]["mean_of_successes"]["command_change"] for level in levels]
        rows.append([name, *(_number("command_change", change) for change in changes)])
    return (
        "## Commands\n\n"
        f"Top: a run of the data ({data['source']}); below: each learned pilot from the same "
        "start and, where the run records it, in the same weather.\n\n![Commands](figures/commands.png)\n\n"
        f"In the data the command changes by **{data['command_change']:.4f}** a step (throttle and angle "
        "together, each as a share of its range; 0 for a constant command). In the successful episodes it "
        "is:\n\n" + table(["pilot", *levels], rows)
    )


def _costs(results: Results) -> str:
    means = {
        f"{name}, {level}": pilot["levels"][level]["mean_of_successes"]
        for level in _levels(results)
        for name, pilot in results["pilots"].items()
    }
    columns = [*COSTS, *(cost for cost in ELECTRIC if all(cost in costs for costs in means.values()))]
    rows = [[who, *(_number(cost, costs[cost]) for cost in columns)] for who, costs in means.items()]
    electric = (
        " Electric energy is the energy drawn from all battery packs, hotel load included. Range is the "
        "distance left above the reserve at that energy per metre, from the state of charge that the level "
        "gives, by default full packs."
    )
    return (
        "## Costs of successful episodes\n\n"
        "Means over the successful episodes. The energy of the jets is the kinetic energy of their wake."
        + (electric if ELECTRIC[0] in columns else "")
        + "\n\n"
        + table(["pilot, level", *(COST_NAMES[cost][0] for cost in columns)], rows)
    )


def _differences(results: Results) -> str:
    shown = ("time", "command_change")
    rows = []
    for found in results["differences"]:
        spans = [difference(what, found[what]) for what in ("success", *shown)]
        rows.append([f"{found['a']} − {found['b']}, {found['level']}", *spans])
    return (
        "## Paired differences\n\n"
        "Paired over the shared episodes, each with its own 95 % interval, not corrected for the number of "
        "comparisons: success over all episodes (Tango's score interval), costs over those in which both "
        "succeeded (bootstrap; too narrow with fewer than about five episodes, none with one). "
        "`results.json` also has path and energy.\n\n"
        + table(["difference", "success [%]", *(COST_NAMES[cost][0] for cost in shown)], rows)
    )


def _again(results: Results) -> str:
    measured = results["measured"]
    return (
        "## Files, and how to repeat this\n\n"
        "* `rerun demo.rrd` shows the run of the data and the learned pilots on a common time axis; "
        "`swamp-rl demo` on this folder shows these and any other run in it.\n"
        "* `episodes.parquet` has a row for each episode of each pilot.\n"
        "* `pilots/` holds the pilots, `config/` the experiment with every option written out and copies of "
        "the files it names, `versions.json` the versions; `sha256sum -c data.sha256` checks the runs.\n"
        "* `swamp-rl run` on this folder repeats it, with the same numbers on the same machine.\n\n"
        "## Wall-clock time\n\n" + time_table(measured)
    )


def time_table(measured: Mapping[str, Any]) -> str:
    """Every stage of a job with its wall-clock time, and the machine that it ran on."""
    total, machine = measured["total_seconds"], measured["hardware"]
    rows = [
        [name, f"{seconds:.1f}", f"{100 * seconds / max(total, 1e-9):.0f}"]
        for name, seconds in measured["seconds"].items()
    ]
    return (
        f"{total:.0f} s of wall-clock time and at most {measured['peak_memory_gb']:.1f} GB, "
        f"on {machine['processors']} processors ({machine['processor']}, {machine['platform']}).\n\n"
        + table(["stage", "seconds", "percent"], rows)
    )


def _number(cost: str, value: float | None) -> str:
    return "–" if value is None else COST_NAMES[cost][1].format(value)


def difference(what: str, interval: Mapping[str, Any]) -> str:
    """A paired difference with its interval, in the unit of its quantity; a dash where there is no pair."""
    if interval["value"] is None:
        return "–"
    scale, form = (100.0, "{:+.1f}") if what == "success" else (1.0, COST_NAMES[what][1].replace(":", ":+"))
    value, low, high = (
        None if interval[end] is None else form.format(scale * interval[end])
        for end in ("value", "low", "high")
    )
    return f"{value} ({low} to {high})" if low is not None else f"{value}"
