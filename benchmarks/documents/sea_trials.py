"""SWAMP's printed figures against the thesis's own model, and against the boat as measured.

python -m benchmarks.documents.sea_trials

Does what `swamp-rl diagnose configs/trials/thesis_figures.yaml` does, for the tables of docs/sea_trials.md.
"""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import load_boat
from swamp_rl.boat.load import boat_chain
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.result import Cause
from swamp_rl.files import find_config
from swamp_rl.printed_figures.diagnose import diagnose_figures
from swamp_rl.printed_figures.predict import fleet_of, misfits, predicted
from swamp_rl.printed_figures.result import FiguresDiagnosis, StageFound
from swamp_rl.printed_figures.schema import FiguresFile, read_figures

GIVEN, MEASURED = "swamp-thesis", "swamp"
FIGURES = find_config("trials", "thesis_figures")
SHOWN = 8  # candidates of a stage
SIGNS = {"at_most": "≤ ", "at_least": "≥ ", None: ""}


def figures_table(found: FiguresDiagnosis, file: FiguresFile) -> str:
    """Every figure: printed, with the boat file, extended, and of the boat as measured."""
    fleet = fleet_of(boat_chain(MEASURED), file)
    values = predicted(fleet, file.figures, Hypothesis(), np.zeros(0))
    off = misfits(file.figures, values)
    rows = []
    for i, one in enumerate(found.figures):
        cells = [
            (one.boat_file, one.boat_file_off),
            (one.extended, one.extended_off),
            (float(values[i]), float(off[i])),
        ]
        printed = f"{SIGNS[one.limit]}{one.printed:.3g} ± {one.error:.2g} {one.unit}"
        rows.append(
            [
                f"{one.group}: {one.name}, {one.mass:g} kg",
                one.use,
                printed,
                *(f"{value:.3g} ({away:+.1f})" for value, away in cells),
                f"{one.source}{': ' * bool(one.reading)}{one.reading}",
            ]
        )
    heads = ["figure", "use", "printed", GIVEN, "extended", MEASURED, "source and reading"]
    return table(heads, rows)


def numbers(causes: Sequence[Cause]) -> str:
    """The causes with their numbers and standard errors."""
    return "; ".join(
        f"`{cause.effect}` "
        + ", ".join(
            f"{name} {one.value:.3g} ± {one.standard_error:.2g}{'' if one.unit == '1' else ' ' + one.unit}"
            for name, one in cause.parameters.items()
        )
        for cause in causes
    )


def stage_text(number: int, stage: StageFound) -> str:
    """The groups of a stage, its result, and the alternatives that it does not distinguish."""
    rows = [[one.effect, f"{one.chi2:.1f}", f"{one.evidence:.1f}"] for one in stage.candidates[:SHOWN]]
    lines = [
        f"### Stage {number}: {', '.join(stage.groups)}",
        f"**{' + '.join(stage.named) or 'nothing'}** is named: chi2 of {stage.figures} figures "
        f"{stage.chi2_before:.1f} before, {stage.chi2_after:.1f} with it.",
        table(["candidate", "chi2", "−2 log marginal likelihood above the first"], rows),
    ]
    if len(stage.without_particulars) > 1:
        lines.append(
            "Without the particulars, the figures do not distinguish: "
            f"{'; '.join(stage.without_particulars)}. The estimates of the first are then "
            f"{numbers(stage.alone)}."
        )
    lines += [
        f"By these figures −2 log marginal likelihood of `{one.effect}` is {one.evidence:.1f} higher, too "
        f"little to distinguish it. Chi2 of the held-out circle is {one.of_the_first:.1f} with the first and "
        f"{one.held_out_chi2:.1f} with it: "
        f"{'distinguished' if one.told_apart else 'not distinguished'}. "
        "The extension is the first's in either case."
        for one in stage.rivals
    ]
    return "\n\n".join(lines)


def gain_text(found: FiguresDiagnosis) -> str:
    """chi2 of every group before and after, and the search with the circles exchanged."""
    rows = [
        [one.group, one.use, str(one.figures), f"{one.chi2_before:.1f}", f"{one.chi2_after:.1f}"]
        for one in found.gain
    ]
    lines = [table(["group", "use", "figures", f"chi2, {GIVEN}", "chi2, extended"], rows)]
    lines += [
        f"With `{one.fitted}` fitted to in place of `{one.judged}`: "
        f"{' + '.join(one.named) or 'nothing'} is identified in addition to the thrust law "
        f"({numbers(one.causes)}). "
        f"Chi2 of `{one.judged}` goes from {one.chi2_before:.1f} to {one.chi2_after:.1f}."
        for one in found.exchange
    ]
    return "\n\n".join(lines)


def main() -> None:
    """Write the measured parts of docs/sea_trials.md."""
    with TemporaryDirectory() as folder:
        found = diagnose_figures(FIGURES, GIVEN, Path(folder) / "out")
    stages = (stage_text(number, stage) for number, stage in enumerate(found.stages, 1))
    parts = {
        "verdict": f"Verdict: **{found.verdict.replace('_', ' ')}**. {numbers(found.causes)}.",
        "stages": "\n\n".join(stages),
        "gain": gain_text(found),
        "figures": figures_table(found, read_figures(FIGURES, load_boat(GIVEN))),
    }
    write_parts(DOCS / "sea_trials.md", parts)


if __name__ == "__main__":
    main()
