"""The report of a diagnosis of printed figures: one HTML page, which needs no other file."""

import html
from collections.abc import Sequence

from swamp_rl.boat import Boat
from swamp_rl.criticism.report.page import CAUSES
from swamp_rl.criticism.report.words import cause_rows, readable
from swamp_rl.criticism.result import Cause
from swamp_rl.html_page import document, minus, rounded, table
from swamp_rl.printed_figures.result import FiguresDiagnosis, GroupFound, StageFound
from swamp_rl.printed_figures.schema import FiguresFile

MEANING = {
    "cause": "The effects below explain the figures that they were fitted to; no other set of effects that "
    "was tried is as likely.",
    "indistinguishable": "Several sets of effects explain the figures; the most likely one extends the boat.",
    "unexplained": "No set of effects that was fitted explains the figures within their errors.",
    "nothing_wrong": "The boat file explains the figures within their errors.",
}


def page(found: FiguresDiagnosis, file: FiguresFile, boat: Boat) -> str:
    """The whole page."""
    title = f"Diagnosis of the model of {boat.name} from {len(found.figures)} printed figures"
    parts = [
        f'<span class="badge {found.verdict}">{found.verdict.replace("_", " ")}</span>',
        f"<h1>{html.escape(title)}</h1><p>{MEANING[found.verdict]}</p>",
        f'<p class="soft">{html.escape(file.name)}: {html.escape(file.description)}</p>',
        _figures(found),
        "<h2>Causes</h2>" + _numbers(found.causes, boat),
        *(_stage(number, stage, boat) for number, stage in enumerate(found.stages, 1)),
        _gain(found.gain),
        _exchange(found, boat),
        _particulars(file),
    ]
    return document(title, parts)


def _numbers(causes: Sequence[Cause], boat: Boat) -> str:
    return table(CAUSES, cause_rows(causes, boat), numbers=(3, 4, 6)) if causes else "<p>Nothing.</p>"


def _figures(found: FiguresDiagnosis) -> str:
    signs = {"at_most": "≤ ", "at_least": "≥ ", None: ""}
    rows = [
        (
            one.group,
            f"{one.name}, {one.mass:g} kg",
            f"{signs[one.limit]}{minus(rounded(one.printed))} ± {one.error:.2g} {one.unit}",
            f"{minus(rounded(one.boat_file))} ({minus(f'{one.boat_file_off:+.1f}')})",
            f"{minus(rounded(one.extended))} ({minus(f'{one.extended_off:+.1f}')})",
            one.use,
            f"{one.source}{': ' * bool(one.reading)}{one.reading}",
        )
        for one in found.figures
    ]
    printed = "printed ± one standard deviation"
    heads = ("group", "figure", printed, "boat file", "extended", "use", "source and reading")
    return (
        "<h2>Figures</h2><p>In brackets: difference from the printed value, in its standard deviations. "
        "<i>alternative</i>: another reading of the same words, shown and not used.</p>"
        + table(heads, rows, numbers=(2, 3, 4))
    )


def _stage(number: int, stage: StageFound, boat: Boat) -> str:
    named = readable(" + ".join(stage.named) or "nothing")
    sentence = (
        f"<h2>Stage {number}: {html.escape(', '.join(stage.groups))}</h2>"
        f"<p>Named: <b>{html.escape(named)}</b>. χ² of {stage.figures} figures: {stage.chi2_before:.1f} "
        f"before, {stage.chi2_after:.1f} with it. The evidence is −2 log of the marginal likelihood (Laplace "
        "approximation), plus the penalty for choosing among the candidates; a difference of 6 is strong "
        "evidence.</p>"
    )
    rows = [
        (readable(one.effect), f"{one.chi2:.1f}", minus(f"{one.evidence:.1f}")) for one in stage.candidates
    ]
    sentence += table(("candidate", "χ² of the figures", "evidence above the first"), rows, numbers=(1, 2))
    if len(stage.without_particulars) > 1:
        alike = "; ".join(readable(one) for one in stage.without_particulars)
        sentence += (
            f"<p>The figures alone, without the particulars, do not distinguish: {html.escape(alike)}.</p>"
        )
    if stage.alone:
        sentence += "<p>Parameters of the first from the figures alone:</p>" + _numbers(stage.alone, boat)
    for one in stage.rivals:
        answer = "These separate the two" if one.distinguished else "These do not separate the two either"
        sentence += (
            f"<p>Not distinguished from the first by these figures: "
            f"<b>{html.escape(readable(one.effect))}</b>, "
            f"{one.evidence:.1f} above. χ² of the figures that judge it: {one.held_out_chi2:.1f}, of the "
            f"first {one.of_the_first:.1f}. {answer}.</p>" + _numbers(one.causes, boat)
        )
    if stage.unseen:
        unseen = html.escape(", ".join(stage.unseen))
        sentence += f'<p class="soft">Not identifiable from these figures: {unseen}.</p>'
    return sentence


def _gain(gain: Sequence[GroupFound]) -> str:
    rows = [
        (one.group, one.use, str(one.figures), f"{one.chi2_before:.1f}", f"{one.chi2_after:.1f}")
        for one in gain
    ]
    heads = ("group", "use", "figures", "χ², boat file", "χ², extended")
    return "<h2>Gain</h2>" + table(heads, rows, numbers=(2, 3, 4))


def _exchange(found: FiguresDiagnosis, boat: Boat) -> str:
    sentence = ""
    for one in found.exchange:
        named = html.escape(readable(" + ".join(one.named) or "nothing"))
        sentence += (
            f"<h2>{html.escape(one.fitted)} fitted in place of {html.escape(one.judged)}</h2>"
            f"<p>Named in addition to the effects of the stages before: <b>{named}</b>. χ² of "
            f"{html.escape(one.judged)}: {one.chi2_before:.1f} with the boat file, {one.chi2_after:.1f} with "
            "the boat extended by them.</p>" + _numbers(one.causes, boat)
        )
    return sentence


def _particulars(file: FiguresFile) -> str:
    rows = [
        (f"{one.effect} {one.parameter}", f"{one.value:g} ± {one.error:g}", one.source)
        for one in file.particulars
    ]
    return (
        "<h2>Particulars</h2><p>Values of effect parameters from the sources, used as Gaussian priors of the "
        "fit.</p>" + table(("parameter", "value ± one standard deviation", "source"), rows, numbers=(1,))
        if rows
        else ""
    )
