"""Level R, sailed by another simulator: its own table, since no model is right there."""

from collections.abc import Sequence

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.blind.score import Judged, is_false_positive, share
from benchmarks.blind.weather import LONGEST, least, rate, verdict
from swamp_rl.constants import Z95

SINGLE, ALARMS = 0.85, 0.02  # bars: effects named alone, false alarms in clean cases


def rough_table(results: Sequence[Judged]) -> str:
    """Rates of level R with Wilson's 95 % interval and the number of cases, their bars and whether each is
    reached; and every wrong answer.
    """
    single = [r for r in results if r["kind"] == "single"]
    alarms = share([is_false_positive(r) for r in results if r["kind"] == "clean"])
    numbers = [number for r in results for number in r["estimates"]]
    seconds = [r["processor_s"] for r in results]
    rows = [
        ["cases", str(len(results)), ""],
        least("one effect, identified and no other", [r["alone"] for r in single], SINGLE),
        ["one effect, identified, alone or with others", rate(share([_named(r) for r in single])), ""],
        [
            "no effect, a cause named",
            rate(alarms),
            verdict(alarms["rate"] <= ALARMS, f"{ALARMS:g}") if alarms else "",
        ],
        ["interval coverage", rate(share([abs(n["away"]) <= Z95 for n in numbers])), ""],
        ["processor s, median", f"{np.median(seconds):.3g}", ""],
        ["processor s, longest", f"{max(seconds):.3g}", verdict(max(seconds) <= LONGEST, f"{LONGEST:g} s")],
    ]
    wrong = [[r["case"], r["truth"], r["named"]] for r in results if not r["right"]]
    return table(["", "R", "target"], rows) + "\n\n" + table(["wrong case", "true causes", "named"], wrong)


def _named(result: Judged) -> bool:
    return result["truth"] in result["named"].split(" + ")
