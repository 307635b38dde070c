"""`compare.md` and the table on the screen: a comparison as text and tables."""

from collections.abc import Mapping, Sequence
from typing import Any

from swamp_rl.experiments.reports.experiment import COST_NAMES, difference, table

from swamp_rl.clipped import in_markdown

Found = Mapping[str, Any]

DIFFERENCE_HEADS = ("mean (95 %, uncorrected)", "p (Holm)")
SUCCESS_PAIRED = (
    "## Success rate, paired differences\n\n"
    "Paired over the episodes. Intervals: with one training seed Tango's score interval, with several "
    "Gaffke's for bounded differences. p is from a sign-flip test, corrected by Holm over all {} comparisons "
    "of this report. The intervals are not corrected, so one may exclude zero where p is above "
    "0.05: decide by p. Both hold for these trained pilots."
)
COSTS_PAIRED = (
    "## Costs, paired differences\n\n"
    "Paired over the episodes in which both succeeded. Intervals: a bootstrap, none over a single episode; p "
    "as above."
)


def report(found: Found) -> str:
    """The comparison as Markdown."""
    notes = "".join(f"\n\n**{note}**" for note in found["notes"])
    levels = ", ".join(f"{n} at `{level}`" for level, n in found["levels"].items())
    parts = [
        f"# Pilots compared\n\nBoat {in_markdown(str(found['boat']))} on the course "
        f"{in_markdown(str(found['course']))}, in the same episodes: {levels}.{notes}",
        success(found),
        differences(found, ("success",), SUCCESS_PAIRED.format(found["comparisons"])),
        differences(found, tuple(COST_NAMES), COSTS_PAIRED),
        improvement(found),
        "Results: " + ", ".join(f"`{folder}`" for folder in found["folders"]) + f". Seed {found['seed']}.",
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def rows(found: Found) -> list[list[str]]:
    """Name, number of training seeds, success at each level and over all, in percent with intervals."""
    return [
        [
            pilot["name"],
            str(pilot["seeds"]),
            *(percent(pilot["levels"][level]["success"]) for level in found["levels"]),
            percent(pilot["all_levels"]),
        ]
        for pilot in found["pilots"]
    ]


def heads(found: Found) -> list[str]:
    """Of the columns of `rows`."""
    return ["pilot", "seeds", *found["levels"], "all levels"]


def success(found: Found) -> str:
    """The table of success rates."""
    return (
        "## Success rate\n\n"
        "Percent. With one training seed: Wilson's 95 % interval over the episodes, of this one trained "
        "pilot. With several: the interquartile mean over them, of the training method, with a 95 % interval "
        "of the seeds (bootstrap) and the episodes (Wilson). Fewer than about five seeds make it too "
        "narrow. All levels: the mean over the levels.\n\n" + success_table(found)
    )


def success_table(found: Found) -> str:
    """Success by pilot and level."""
    return table(heads(found), rows(found))


def differences(found: Found, quantities: Sequence[str], opening: str) -> str:
    """Paired differences in some quantities with their corrected p-values, below a title and method."""
    lines = []
    for row in found["differences"]:
        if row["quantity"] in quantities:
            name = "success [%]" if row["quantity"] == "success" else COST_NAMES[row["quantity"]][0]
            span, p = difference(row["quantity"], row), p_value(row["p_corrected"])
            lines.append([f"{row['a']} − {row['b']}, {row['level']}", name, span, str(row["n"]), p])
    if not lines:
        return ""
    heads = ["difference", "of", *DIFFERENCE_HEADS[:1], "episodes", *DIFFERENCE_HEADS[1:]]
    return f"{opening}\n\n{table(heads, lines)}"


def improvement(found: Found) -> str:
    """Chance that another training of one beats another training of the other."""
    if not any(pilot["seeds"] > 1 for pilot in found["pilots"]) or not found["improvement"]:
        return ""
    return (
        "## Probability of improvement\n\n"
        "Probability of improvement in success over the training seeds, averaged over the levels, in "
        "percent; 50 is no difference. Agarwal and others (2021).\n\n" + improvement_table(found)
    )


def improvement_table(found: Found) -> str:
    """Probability of improvement of each pair of pilots, in percent."""
    lines = [[f"{row['a']} over {row['b']}", percent(row), str(row["n"])] for row in found["improvement"]]
    return table(["pilot over pilot", "probability", "seeds, at least"], lines)


def percent(interval: Mapping[str, Any]) -> str:
    """A rate with its interval where there is one."""
    value, low, high = (interval[end] for end in ("value", "low", "high"))
    if low is None:
        return f"{100 * value:.1f}"
    return f"{100 * value:.1f} ({100 * low:.1f}–{100 * high:.1f})"


def p_value(p: float | None) -> str:
    """With two significant digits, and no more zeros than mean anything."""
    if p is None:
        return "–"
    return "< 0.0001" if p < 1e-4 else f"{p:.2g}" if p < 0.1 else f"{p:.2f}"
