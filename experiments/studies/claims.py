"""The claims of thesis 7.3.3 as tested hypotheses: a pilot trained anew many times, tried where they say."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from swamp_rl.experiments.artifacts.provenance import WORK, seeds
from swamp_rl.experiments.artifacts.results import data_results
from swamp_rl.experiments.artifacts.stages import Stages, measured
from swamp_rl.experiments.config.claims import Claims
from swamp_rl.experiments.config.digests import write_hashes
from swamp_rl.experiments.config.learners import check_count, learner
from swamp_rl.experiments.config.scene import Scene
from swamp_rl.experiments.config.schema import PilotPlan
from swamp_rl.experiments.evaluation.comparison import without_nan
from swamp_rl.experiments.reports.claims import report
from swamp_rl.experiments.studies.claims_effects import CLAIMS, Hypothesis, count, hypotheses, title
from swamp_rl.experiments.studies.claims_episodes import fly
from swamp_rl.experiments.training.train import get_data

from swamp_rl.counted import counted
from swamp_rl.errors import UserError, errors_at
from swamp_rl.evaluation import holm, sign_flip_test
from swamp_rl.evaluation.crossed import crossed_mean
from swamp_rl.pilots.demonstrations import choose_runs
from swamp_rl.runs import Run

LEVEL = 0.05
SUPPORTED, NOT_SUPPORTED, UNDECIDED = "supported", "not supported", "undecided"


def check_claims(scene: Scene) -> Claims:
    """The claims of an experiment; UserError where they name what it has not."""
    plan = scene.experiment.claims
    assert plan is not None
    if plan.pilot not in scene.experiment.pilots:
        known = ", ".join(scene.experiment.pilots)
        raise UserError(f"claims.pilot: no pilot {plan.pilot!r}; name one of {known}")
    if not learner(scene.experiment.pilots[plan.pilot].kind).from_runs:
        raise UserError(f"claims.pilot: {plan.pilot} does not learn from runs; name one that does")
    with errors_at(f"claims.runs: pilots.{plan.pilot}"):
        check_count(scene.experiment.pilots[plan.pilot], min(plan.runs))
    if plan.few not in plan.runs:
        raise UserError(f"claims.few: {plan.few} is not in claims.runs; add it there")
    for level in (plan.at, plan.calm, *plan.disturbed, *plan.elsewhere):
        if level not in scene.levels:
            raise UserError(f"claims: level {level!r} is not in evaluation.levels; add it there")
    return plan


def least_draws(plan: Claims) -> int:
    """Trainings from which a hypothesis can be supported: with n, no corrected p is below that of Holm's
    first step, the number of hypotheses over 2^n.
    """
    return math.floor(math.log2(count(plan) / LEVEL)) + 1


def draws_note(plan: Claims) -> str | None:
    """One line where there are too few trainings to support anything; else None."""
    if plan.draws >= least_draws(plan):
        return None
    least = min(1.0, count(plan) / 2**plan.draws)
    return (
        f"claims.draws: {plan.draws} trainings cannot support any of {count(plan)} hypotheses (p is at least "
        f"{least:.2g}); give {least_draws(plan)} or more"
    )


def examine_claims(scene: Scene, folder: Path, progress: Stages) -> dict[str, Any]:
    """Every stage in turn; what goes into results.json. The report is written beside."""
    plan = check_claims(scene)
    if note := draws_note(plan):
        progress.say(note)
    dataset = get_data(scene, folder, progress)
    taught = scene.experiment.pilots[plan.pilot]
    pool = pool_of(plan, taught, dataset.runs)
    rng = np.random.default_rng(scene.experiment.evaluation.seed)
    lessons = blocks(pool, plan.draws, max(plan.runs), rng)
    flown = fly(scene, plan, dataset, lessons, progress, folder / WORK / "flown")
    with progress.stage("test the hypotheses"):
        rows = judge(hypotheses(plan, flown), rng)
    results = {
        "name": scene.experiment.name,
        "description": scene.experiment.description,
        "boat": scene.boat.name,
        "course": scene.course.name,
        "plan": plan.model_dump(mode="json"),
        "too_few_draws": draws_note(plan),
        "takeover": taught.takeover,
        "kind": taught.kind,
        "episodes": len(scene.seeds),
        "data": data_results(dataset) | {"recorded_at": recorded_at(scene), "disjoint": disjoint(plan, pool)},
        "sha256": write_hashes(dataset.folder, folder),
        "seeds": seeds(scene.experiment),
        "claims": [claim_row(claim, rows, plan) for claim in CLAIMS],
        "measured": measured(progress),
    }
    (folder / "report.md").write_text(report(results), encoding="utf-8")
    return results


def pool_of(plan: Claims, taught: PilotPlan, runs: Sequence[Run]) -> list[Run]:
    """The runs that the pilot may be trained on; UserError where they are fewer than a claim asks for."""
    pool = choose_runs(runs, None, taught.outcomes, taught.skill)
    if len(pool) < max(plan.runs):
        raise UserError(
            f"claims.runs: {counted(max(plan.runs), 'run')} asked for, {len(pool)} found; record more"
        )
    return pool


def recorded_at(scene: Scene) -> str | None:
    """The level of the recorded runs; None where the data were given."""
    data = scene.experiment.data
    return None if data.folder is not None else Path(data.record.disturbances or "no disturbance").stem


def disjoint(plan: Claims, pool: Sequence[Run]) -> bool:
    """Whether no run is in two draws of `few` runs."""
    return len(pool) >= plan.draws * plan.few


def blocks(pool: Sequence[Run], draws: int, size: int, rng: np.random.Generator) -> list[list[Run]]:
    """`draws` random choices of `size` runs, none twice in a choice, and in two only where there are too few.

    The first n of each choice are its choice of n.
    """
    order = [pool[i] for i in rng.permutation(len(pool))]
    apart = max(len(order) // draws, 1)
    return [[order[(draw * apart + i) % len(order)] for i in range(size)] for draw in range(draws)]


def judge(asked: Sequence[Hypothesis], rng: np.random.Generator) -> list[dict[str, Any]]:
    """Each hypothesis with effect, interval, p-value (of the trainings' means, one-sided) and verdict."""
    rows: list[dict[str, Any]] = []
    for one in asked:
        known = np.isfinite(one.values)
        means = np.where(known, one.values, 0.0).sum(axis=1)[known.any(axis=1)]
        means = means / known.sum(axis=1)[known.any(axis=1)]
        found = crossed_mean(one.values, rng)
        p = sign_flip_test(means - one.bound, rng, greater=True) if len(means) else float("nan")
        fields = {what: value for what, value in vars(one).items() if what != "values"}
        rows.append(fields | asdict(found) | {"trials": int(known.sum()), "p": p})
    for row, corrected in zip(rows, holm([row["p"] for row in rows]), strict=True):
        row["p_corrected"] = corrected
        row["verdict"] = verdict(row)
    return [without_nan(row) for row in rows]


def verdict(row: Mapping[str, Any]) -> str:
    """Supported where the whole interval is above the bound and the corrected p-value below `LEVEL`.

    Not supported where the whole interval is below the bound; else undecided.
    """
    if row["low"] > row["bound"] and row["p_corrected"] < LEVEL:
        return SUPPORTED
    return NOT_SUPPORTED if row["high"] < row["bound"] else UNDECIDED


def claim_row(claim: str, rows: Sequence[Mapping[str, Any]], plan: Claims) -> dict[str, Any]:
    """A claim is supported where all that decide it are, and not where one is not."""
    own = [row for row in rows if row["claim"] == claim]
    verdicts = {row["verdict"] for row in own if row["decides"]}
    if verdicts == {SUPPORTED}:
        found = SUPPORTED
    else:
        found = NOT_SUPPORTED if NOT_SUPPORTED in verdicts else UNDECIDED
    return {"claim": claim, "title": title(claim, plan), "verdict": found, "hypotheses": own}
