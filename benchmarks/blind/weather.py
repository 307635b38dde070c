"""Level E, another wind or current in each run: its own table, since its cases have bars of their own."""

from collections.abc import Mapping, Sequence

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.blind.score import Judged, share
from swamp_rl.constants import Z95

Rate = Mapping[str, float] | None
ALONE, BESIDE = "single", "pair"  # kinds of its cases
COVER = 0.93, 0.97
LONGEST = 60.0  # s of a case


def weather_table(results: Sequence[Judged]) -> str:
    """Rates of level E with Wilson's 95 % interval and the number of cases, their bars and whether each is
    reached.
    """
    alone = [r for r in results if r["kind"] == ALONE]
    beside = [r for r in results if r["kind"] == BESIDE]
    runs = [number for r in results for number in r["run_estimates"]]
    held = share([abs(number["away"]) <= Z95 for number in runs])
    others = share([abs(number["away"]) <= Z95 for r in results for number in r["estimates"]])
    seconds = [r["processor_s"] for r in results]
    rows = [
        ["cases", str(len(results)), ""],
        least("wind or current alone, identified", [r["alone"] for r in alone], 0.97),
        least(
            "with one effect, both identified, alone or in a small set", [r["right"] for r in beside], 0.95
        ),
        ["with one effect, both identified alone", rate(share([r["alone"] for r in beside])), ""],
        ["interval coverage, wind or current of the runs", rate(held), within(held)],
        ["interval coverage, other parameters", rate(others), ""],
        ["processor s, median", f"{np.median(seconds):.3g}", ""],
        ["processor s, longest", f"{max(seconds):.3g}", verdict(max(seconds) <= LONGEST, f"{LONGEST:g} s")],
    ]
    return table(["", "E", "target"], rows)


def least(name: str, flags: Sequence[bool], bar: float) -> list[str]:
    """A row of a rate that has a least value."""
    found = share(flags)
    verdict_text = "" if found is None else verdict(found["rate"] >= bar, f"{bar:g}")
    return [name, rate(found), verdict_text]


def within(found: Rate) -> str:
    """Whether a coverage is in its bar, or its interval overlaps with that."""
    if found is None:
        return ""
    inside = COVER[0] <= found["rate"] <= COVER[1]
    near = found["low"] <= COVER[1] and found["high"] >= COVER[0]
    return f"{COVER[0]:g} to {COVER[1]:g}: " + ("reached" if inside else "short" if near else "missed")


def verdict(holds: bool, bar: str) -> str:
    """A bar and whether it is reached."""
    return f"{bar}: {'reached' if holds else 'missed'}"


def rate(found: Rate) -> str:
    """A rate with its interval and count."""
    return (
        "-"
        if found is None
        else f"{found['rate']:.3f} ({found['low']:.2f} to {found['high']:.2f}; {found['of']:.0f})"
    )
