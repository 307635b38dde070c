"""Diagnosis of a boat file from printed figures: causes, their parameters, and the gain of adding them."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from swamp_rl.boat.load import boat_chain, boat_of_chain
from swamp_rl.criticism.data.checks import refuse_sources_inside
from swamp_rl.criticism.inference.estimate import cause_of
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.model.extended_boat import write_extended
from swamp_rl.criticism.options import options
from swamp_rl.criticism.result import Cause, Verdict
from swamp_rl.errors import UserError, errors_at
from swamp_rl.printed_figures.predict import Fleet, fleet_of, misfits, predicted
from swamp_rl.printed_figures.result import (
    CandidateFound,
    Exchanged,
    FigureFound,
    FiguresDiagnosis,
    GroupFound,
    RivalFound,
    StageFound,
)
from swamp_rl.printed_figures.schema import Figure, FiguresFile, group_faults, read_figures
from swamp_rl.printed_figures.select import (
    NOWHERE,
    Fitted,
    Problem,
    Stage,
    instances_of,
    priors_of,
    rivals_of,
    stage_of,
)
from swamp_rl.unfinished import folder_beside

RESULT = "diagnosis.json"
NOTHING = Fitted(Hypothesis(), NOWHERE, np.zeros((0, 0)), 0.0, 0.0)

Groups = Sequence[Sequence[str]]


@dataclass(frozen=True)
class Study:
    """A figures file with the boat at its loads."""

    found: FiguresFile
    fleet: Fleet

    def of(self, groups: Sequence[str]) -> tuple[Figure, ...]:
        """The figures of groups, without alternative readings."""
        return tuple(one for one in self.found.figures if one.group in groups and not one.alternative)

    def chi2(self, groups: Sequence[str], fitted: Fitted) -> float:
        """Of the figures of groups; 0 where there are none."""
        figures = self.of(groups)
        if not figures:
            return 0.0
        values = predicted(self.fleet, figures, fitted.hypothesis, fitted.x)
        return float((misfits(figures, values) ** 2).sum())

    def stages_of(self, fit: Groups, begun: Sequence[Stage] = ()) -> list[Stage]:
        """The stages of `fit`, each on the figures of all up to it; begun: the first of them, where known."""
        instances, priors = instances_of(self.fleet.nominal), priors_of(self.found.particulars)
        stages = list(begun)
        for number in range(len(stages), len(fit)):
            groups = [group for stage in fit[: number + 1] for group in stage]
            problem = Problem(self.fleet, self.of(groups), priors)
            base = stages[-1].winner if stages else NOTHING
            stages.append(stage_of(problem, tuple(fit[number]), base, instances))
        return stages


def study_of(path: Path, boat: str) -> Study:
    """The figures file at a path with a boat, by name or file, at its loads; UserError, a line a fault."""
    chain = boat_chain(boat)
    found = read_figures(path, boat_of_chain(chain))
    with errors_at(path):  # the boat itself was read: it is a load or the water
        return Study(found, fleet_of(chain, found))


def diagnose_figures(path: Path, boat: str, out: Path, fit: Groups | None = None) -> FiguresDiagnosis:
    """Diagnose a boat file against the printed figures of a YAML file; writes diagnosis.json,
    extended_boat.yaml and report.html into `out`.

    fit: groups by stage that parameters are fitted to, in place of the file's. UserError, one line for each
    fault of the file.
    """
    from swamp_rl.printed_figures.report import page

    began = time.perf_counter()
    refuse_sources_inside(out, [one for one in (path, Path(boat)) if one.exists()])
    study = study_of(path, boat)
    found = study.found
    faults = group_faults(found, fit or ())
    if faults:
        raise UserError("\n".join(f"--fit: {fault.removeprefix('fit: ')}" for fault in faults))
    with folder_beside(out, RESULT) as folder:
        diagnosis, last = examine(study, fit or found.fit)
        diagnosis.elapsed_s = time.perf_counter() - began
        write_extended(folder, boat, last.hypothesis, last.x)
        (folder / "report.html").write_text(page(diagnosis, found, study.fleet.nominal), encoding="utf-8")
        (folder / RESULT).write_text(diagnosis.model_dump_json(indent=2) + "\n", encoding="utf-8")
    return diagnosis


def examine(study: Study, fit: Groups) -> tuple[FiguresDiagnosis, Fitted]:
    """The diagnosis, and the hypothesis that extends the boat."""
    stages = study.stages_of(fit)
    last = stages[-1].winner
    used = [group for stage in fit for group in stage]
    swaps = {one: other for one, other in study.found.exchange.items() if one in used and other not in used}
    reports = [_stage(study, stage, list(swaps.values())) for stage in stages]
    sets = [
        [" + ".join(stage.named) or "nothing", *(one.effect for one in stage.rivals if not one.distinguished)]
        for stage in reports
    ]
    sets = [labels for labels in sets if len(labels) > 1]
    scale = 1.0 / np.sqrt(np.maximum(np.diag(last.covariance), 1e-300))
    figures = _figures(study, used, last)
    diagnosis = FiguresDiagnosis(
        verdict=_verdict(last, sets, all(stage.adequate for stage in stages)),
        causes=causes_of(last),
        correlation=(last.covariance * np.outer(scale, scale)).tolist(),
        indistinguishable=sets,
        stages=reports,
        figures=figures,
        gain=_gain(figures),
        exchange=[_exchanged(study, fit, stages, one, other) for one, other in swaps.items()],
        elapsed_s=0.0,
    )
    return diagnosis, last


def _verdict(last: Fitted, sets: list[list[str]], adequate: bool) -> Verdict:
    if not adequate:
        return "unexplained"
    if sets:
        return "indistinguishable"
    return "cause" if last.hypothesis.instances else "nothing_wrong"


def causes_of(fitted: Fitted) -> list[Cause]:
    """Every effect of a fit with its parameters and their standard errors."""
    causes = []
    for instance, own in fitted.hypothesis.parts(fitted.x):
        mine = fitted.hypothesis.columns(instance.label)
        causes.append(cause_of(instance, own, fitted.covariance[np.ix_(mine, mine)]))
    return causes


def _new(stage: Stage, one: Fitted) -> list[str]:
    """Labels of the effects that a fit adds to those of the stages before."""
    known = {instance.label for instance in stage.before.hypothesis.instances}
    return [instance.label for instance in one.hypothesis.instances if instance.label not in known]


def _stage(study: Study, stage: Stage, judging: Sequence[str]) -> StageFound:
    """judging: groups that are not fitted, on which rivals are compared."""
    first, least = stage.winner, stage.winner.evidence
    of_first = study.chi2(judging, first)
    rivals = []
    for one in stage.rivals:
        held_out = study.chi2(judging, one)
        rivals.append(
            RivalFound(
                effect=" + ".join(_new(stage, one)) or "nothing",
                causes=causes_of(one),
                evidence=one.evidence - least,
                held_out_chi2=held_out,
                of_the_first=of_first,
                distinguished=one.evidence - least + held_out - of_first >= options().strong_evidence,
            )
        )
    plain = [stage.plain[0], *rivals_of(stage.plain)]
    same = next((one for one in stage.plain if one.hypothesis == first.hypothesis), None)
    return StageFound(
        groups=list(stage.groups),
        figures=len(stage.figures),
        chi2_before=stage.before.chi2,
        chi2_after=first.chi2,
        named=_new(stage, first),
        adequate=stage.adequate,
        rivals=rivals,
        without_particulars=[" + ".join(_new(stage, one)) or "nothing" for one in plain],
        alone=[] if same is None else causes_of(same),
        candidates=[
            CandidateFound(
                effect=" + ".join(_new(stage, one)) or "nothing",
                chi2=one.chi2,
                evidence=one.evidence - least,
            )
            for one in stage.fits[: options().figures_listed]
        ],
        unseen=list(stage.unseen),
    )


def _figures(study: Study, used: Sequence[str], last: Fitted) -> list[FigureFound]:
    figures = study.found.figures
    before = predicted(study.fleet, figures, Hypothesis(), NOWHERE)
    after = predicted(study.fleet, figures, last.hypothesis, last.x)
    columns = zip(figures, before, after, misfits(figures, before), misfits(figures, after), strict=True)
    return [
        FigureFound(
            group=one.group,
            name=one.name,
            mass=one.mass,
            unit=one.unit,
            printed=one.value,
            error=one.error,
            limit=one.limit,
            use="alternative" if one.alternative else "fitted" if one.group in used else "judged",
            boat_file=float(old),
            extended=float(new),
            boat_file_off=float(old_off),
            extended_off=float(new_off),
            source=one.source,
            reading=one.reading,
        )
        for one, old, new, old_off, new_off in columns
    ]


def _gain(figures: Sequence[FigureFound]) -> list[GroupFound]:
    found = []
    judged = [one for one in figures if one.use != "alternative"]
    for group in dict.fromkeys(one.group for one in judged):
        own = [one for one in judged if one.group == group]
        found.append(
            GroupFound(
                group=group,
                use="fitted" if own[0].use == "fitted" else "judged",
                figures=len(own),
                chi2_before=sum(one.boat_file_off**2 for one in own),
                chi2_after=sum(one.extended_off**2 for one in own),
            )
        )
    return found


def _exchanged(study: Study, fit: Groups, stages: Sequence[Stage], one: str, other: str) -> Exchanged:
    """The search with the group `other` in place of `one`; the stages before it are kept."""
    turned = [[other if group == one else group for group in stage] for stage in fit]
    same = next(i for i, stage in enumerate(fit) if one in stage)
    last = study.stages_of(turned, stages[:same])[-1]
    return Exchanged(
        fitted=other,
        judged=one,
        named=_new(last, last.winner),
        causes=causes_of(last.winner),
        chi2_before=study.chi2([one], NOTHING),
        chi2_after=study.chi2([one], last.winner),
    )
