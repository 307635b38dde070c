"""`report.md` of a closed loop: the diagnosis, and the pilots trained with it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from swamp_rl.experiments.reports.experiment import rate, table, titled
from swamp_rl.experiments.reports.figures import success_rates

from swamp_rl.criticism.report.words import number_cells
from swamp_rl.criticism.result import Estimate

Results = Mapping[str, Any]


def write_report(folder: Path, results: Results) -> None:
    """Write report.md and its figure into `folder`."""
    (folder / "figures").mkdir(exist_ok=True)
    rates = {name: pilot["levels"] for name, pilot in results["pilots"].items()}
    success_rates(folder / "figures" / "success.png", rates, {}, "Success in the true boat")
    (folder / "report.md").write_text(report(results), encoding="utf-8")


def report(results: Results) -> str:
    """The whole text."""
    parts = [
        titled(f"{results['name']}: from logs to a better pilot", results["description"])
        + f"The true boat is `{results['boat']}` with {effects(results)}. Neither the diagnosis "
        "nor the training uses this.",
        found(results),
        "## In the true boat\n\n"
        f"Every pilot in the same {results['evaluation']['episodes']} seeded episodes at each level of "
        "disturbance. Success in percent, with Wilson's 95 % interval. The scripted pilot is not trained; "
        "it is a reference.\n\n" + success(results),
        "Extended minus nominal, paired over the episodes, with Tango's 95 % score interval:\n\n"
        + differences(results),
        f"{verdict(results)}\n\nIt took {results['measured']['total_seconds']:.0f} s.",
    ]
    return "\n\n".join(parts) + "\n"


def effects(results: Results) -> str:
    """The effects of the true boat, with their parameters."""
    lines = []
    for entry in results["hidden"]["effects"]:
        rest = ", ".join(f"{key} {value}" for key, value in entry.items() if key != "effect")
        lines.append(f"`{entry['effect']}` ({rest})")
    return " and ".join(lines)


def causes(results: Results) -> str:
    """The causes that the diagnosis found in the logs."""
    rows = []
    for cause in results["diagnosis"]["causes"]:
        on = cause["thruster"] if isinstance(cause["thruster"], str) else " ".join(cause["thruster"] or ())
        for name, p in cause["parameters"].items():
            rows.append([f"{cause['effect']} {on}".strip(), name, *number_cells(Estimate.model_validate(p))])
    return table(["cause", "parameter", "value", "95 % interval", "unit"], rows)


def found(results: Results) -> str:
    """The diagnosis of the logs."""
    logs, diagnosis = results["hidden"]["logs"], results["diagnosis"]
    verdict = diagnosis["verdict"].replace("_", " ")
    text = (
        f"## Diagnosis of the logs\n\n{logs['runs']} runs of the scripted pilot through the gates, "
        f"logged with sensor noise ({logs['position_noise']} m, {logs['heading_noise']} rad, "
        f"{logs['velocity_noise']} m/s, {logs['yaw_rate_noise']} rad/s). Verdict: **{verdict}**."
    )
    return f"{text}\n\n{causes(results)}" if diagnosis["causes"] else text


def success(results: Results) -> str:
    """Success rates side by side."""
    levels = results["evaluation"]["levels"]
    names = list(dict.fromkeys(name.rsplit(", ", 1)[0] for name in results["pilots"]))
    rows = []
    for name in names:
        for level in levels:
            own = [results["pilots"].get(f"{name}, {s}") for s in ("nominal", "extended")]
            cells = [rate(one["levels"][level]) if one else "" for one in own]
            if not any(cells):
                cells = [rate(results["pilots"][name]["levels"][level]), ""]
            rows.append([f"{name}, {level}", *cells])
    return table(["pilot, level", "trained in the nominal simulator", "trained in the extended one"], rows)


def differences(results: Results) -> str:
    """Paired differences in percent."""
    rows = []
    for one in results["differences"]:
        value, low, high = (100.0 * one["extended_less_nominal"][end] for end in ("value", "low", "high"))
        rows.append([f"{one['pilot']}, {one['level']}", f"{value:+.1f} ({low:+.1f} to {high:+.1f})"])
    return table(["pilot, level", "success [%]"], rows)


def verdict(results: Results) -> str:
    """In words: where the extended simulator made the better pilot."""
    spans = [one["extended_less_nominal"] for one in results["differences"]]
    better, worse = (sum(s["low"] > 0 for s in spans), sum(s["high"] < 0 for s in spans))
    return (
        f"The pilot from the extended simulator is better in {better} of {len(spans)} comparisons and worse "
        f"in {worse}; in the others the interval contains zero."
    )
