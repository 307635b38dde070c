"""The thesis's claims: each verdict follows from its numbers, and the whole runs in small."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from swamp_rl.experiments.artifacts.stages import stages
from swamp_rl.experiments.config.claims import Claims
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import Scene, read_scene
from swamp_rl.experiments.reports.claims import report, shown
from swamp_rl.experiments.studies import claims_episodes as claims_flown
from swamp_rl.experiments.studies.claims import (
    blocks,
    check_claims,
    claim_row,
    disjoint,
    draws_note,
    examine_claims,
    judge,
    pool_of,
)
from swamp_rl.experiments.studies.claims_effects import (
    Flown,
    Hypothesis,
    count,
    lever_power,
    named,
    not_copied,
    title,
)

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.evaluation import Rollout
from swamp_rl.files import find_config
from swamp_rl.runs import Run, RunMeta
from tests.support.runs import circling

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("claims")]  # what they share is made once

SMALL = (
    "data.record.good=6",
    "claims.draws=2",
    "claims.runs=[3,6]",
    "claims.few=3",
    "claims.disturbed=[kicks]",
    "claims.elsewhere=[reversed]",
    "evaluation.episodes=4",
)


PLAN = Claims(pilot="reservoir")


def judged(values: Any, bound: float) -> dict[str, Any]:
    (row,) = judge(
        [Hypothesis("few", "", np.asarray(values, float), bound, "rate")], np.random.default_rng(0)
    )
    return row


def test_far_above_the_bound_in_every_training_is_supported() -> None:
    row = judged(np.random.default_rng(1).normal(0.9, 0.02, (10, 50)), 0.5)
    assert (row["verdict"], row["p"]) == ("supported", pytest.approx(1 / 2**10))


def test_far_below_is_not_supported_and_about_it_is_undecided() -> None:
    rng = np.random.default_rng(2)
    assert judged(rng.normal(0.3, 0.02, (10, 50)), 0.5)["verdict"] == "not supported"
    assert judged(rng.normal(0.5, 0.2, (10, 50)), 0.5)["verdict"] == "undecided"


def test_an_interval_beyond_the_bound_does_not_suffice_with_too_few_trainings() -> None:
    row = judged(np.full((3, 50), 0.9), 0.5)
    assert row["low"] > 0.5 and row["p"] == pytest.approx(1 / 8)
    assert row["verdict"] == "undecided"


def test_nothing_to_count_is_undecided() -> None:
    assert judged(np.full((5, 4), np.nan), 0.5)["verdict"] == "undecided"


def test_p_values_are_corrected_over_all_hypotheses() -> None:
    values = np.random.default_rng(3).normal(0.9, 0.02, (10, 20))
    many = [Hypothesis("few", "", values, 0.5, "rate") for _ in range(4)]
    assert all(
        row["p_corrected"] == pytest.approx(4 / 2**10) for row in judge(many, np.random.default_rng(0))
    )


def test_a_claim_stands_and_falls_with_the_hypotheses_that_decide_it() -> None:
    def row(verdict: str, decides: bool = True) -> dict[str, Any]:
        return {"claim": "few", "verdict": verdict, "decides": decides}

    yes, no, open_ = row("supported"), row("not supported"), row("undecided")
    assert claim_row("few", [yes, yes, row("not supported", decides=False)], PLAN)["verdict"] == "supported"
    assert claim_row("few", [yes, open_], PLAN)["verdict"] == "undecided"
    assert claim_row("few", [yes, open_, no], PLAN)["verdict"] == "not supported"


def runs_named(n: int) -> list[Run]:
    return [Run(str(i), {}) for i in range(n)]


def test_a_claim_names_the_levels_that_were_tried_where_they_are_not_the_thesiss() -> None:
    assert "stern-thruster kicks" in title("disturbed", PLAN)
    assert "reversed heading" in title("elsewhere", PLAN)
    other = Claims(pilot="reservoir", disturbed=("gusts",), elsewhere=("elsewhere",))
    assert title("disturbed", other) == "It withstands disturbances: gusts"
    assert title("elsewhere", other) == "It succeeds from starts outside the training tracks: elsewhere"
    assert claim_row("disturbed", [], other)["title"] == title("disturbed", other)


@pytest.mark.parametrize(("draws", "enough"), [(4, False), (8, False), (9, True), (10, True)])
def test_too_few_trainings_to_support_anything_are_said_beforehand(draws: int, enough: bool) -> None:
    plan = Claims(pilot="reservoir", draws=draws)
    surest = [Hypothesis("few", "", np.full((draws, 5), 0.9), 0.5, "rate")] * count(plan)
    rows = judge(surest, np.random.default_rng(0))
    assert {row["verdict"] for row in rows} == {"supported" if enough else "undecided"}
    assert (draws_note(plan) is None) == enough


def test_choices_of_runs_share_none_where_there_are_enough() -> None:
    chosen = blocks(runs_named(200), 10, 40, np.random.default_rng(0))
    firsts = [run.name for block in chosen for run in block[:20]]
    assert len(set(firsts)) == 200
    assert all(len({run.name for run in block}) == 40 for block in chosen)
    assert disjoint(Claims(pilot="x"), runs_named(200)) and not disjoint(Claims(pilot="x"), runs_named(199))


def test_choices_from_too_few_runs_still_hold_none_twice() -> None:
    chosen = blocks(runs_named(45), 10, 40, np.random.default_rng(0))
    assert all(len({run.name for run in block}) == 40 for block in chosen)


def test_a_saving_is_reported_as_a_share() -> None:
    assert shown("saving", float(np.log(2.0))) == "50.0 %"
    assert shown("points", -0.05) == "-5.0"


def test_full_lever_is_the_power_of_two_jets_at_full_thrust() -> None:
    boat = load_boat("swamp")
    run = Run("full", {"time": np.arange(3.0), "joy_thrust": np.ones(3), "joy_angle": np.zeros(3)})
    # T V_o / 2 with V_o the square root of T / (rho A_n), as in the metrics' own test.
    assert lever_power(run, boat) == pytest.approx(2 * 0.5 * 12.2 * np.sqrt(12.2 / (1025.0 * 900e-6)))


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("claims.pilot=nobody", "no pilot 'nobody'"),
        ("claims.few=7", "7 is not in claims.runs"),
        ("claims.calm=storm", "level 'storm' is not in evaluation.levels"),
        ("pilots.reservoir={kind: scripted, takeover: 0.0}", "does not learn from runs"),
    ],
)
def test_claims_about_what_is_not_there_are_refused(override: str, message: str) -> None:
    scene = read_scene(load_experiment("thesis_claims", [override]))
    with pytest.raises(UserError, match=message):
        check_claims(scene)


def test_a_claim_about_one_drivers_runs_draws_from_his_alone() -> None:
    scene = read_scene(load_experiment("thesis_claims", ["claims.runs=[2, 3]", "claims.few=2"]))
    taught = scene.experiment.pilots["reservoir"].model_copy(update={"skill": "expert"})
    skills = ("novice", "expert", "expert", "expert")
    runs = [
        Run(str(i), circling(), RunMeta.model_validate({"outcome": "success", "skill": skill}))
        for i, skill in enumerate(skills)
    ]
    plan = check_claims(scene)
    assert [run.name for run in pool_of(plan, taught, runs)] == ["1", "2", "3"]
    with pytest.raises(UserError, match="3 runs asked for, 2 found"):
        pool_of(plan, taught, runs[:3])


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    """Few runs, trainings and episodes of at most 45 s."""
    course = yaml.safe_load(find_config("courses", "camogli").read_text(encoding="utf-8"))
    short = tmp_path_factory.mktemp("course") / "short.yaml"
    short.write_text(yaml.safe_dump({**course, "time_limit": 45.0}), encoding="utf-8")
    return read_scene(load_experiment("thesis_claims", [*SMALL, f"course={short}"]))


def examined(scene: Scene, folder: Path) -> dict[str, Any]:
    """What goes into results.json, but for what it took."""
    with stages() as progress:
        results = examine_claims(scene, folder, progress)
    assert (folder / "report.md").read_text(encoding="utf-8") == report(results)
    return {key: value for key, value in results.items() if key != "measured"}


def test_the_whole_in_small_tells_every_claim_and_goes_on_after_a_break_to_the_same_numbers(
    small: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    results = examined(small, tmp_path / "unbroken")
    assert [one["claim"] for one in results["claims"]] == [
        "few",
        "copy",
        "elsewhere",
        "disturbed",
        "smoother",
    ]
    assert all(one["hypotheses"] for one in results["claims"])
    assert sum(len(one["hypotheses"]) for one in results["claims"]) == count(check_claims(small))
    assert "2 trainings cannot support any" in results["too_few_draws"]
    assert "none is of a person" in (tmp_path / "unbroken" / "report.md").read_text(encoding="utf-8")

    def stopped(*_: Any) -> None:
        raise KeyboardInterrupt

    done: list[str] = []
    flight, train = claims_flown.flight, claims_flown.train

    def third_is_the_last(*asked: Any) -> Any:
        if len(done) == 3:
            stopped()
        done.append("flight")
        return flight(*asked)

    def counted(*asked: Any) -> Any:
        trained.append("training")
        return train(*asked)

    trained: list[str] = []
    monkeypatch.setattr(claims_flown, "train", counted)
    for broken in (("flight", third_is_the_last), ("_teacher", stopped)):
        with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):
            patched.setattr(claims_flown, *broken)
            examined(small, tmp_path / "broken")
    assert len(trained) == 4  # 2 draws of 3 and of 6 runs, none of them twice
    assert examined(small, tmp_path / "broken") == results
    assert len(trained) == 4


def test_tracks_of_the_datas_own_kind_are_once_as_far_and_copies_hardly_at_all() -> None:
    rng = np.random.default_rng(4)
    way = np.linspace(0.0, 20.0, 50)

    def track() -> np.ndarray:
        bend, wander = rng.normal(0.0, 1.0), 30.0 * (rng.random() < 0.1)
        return np.column_stack([way, (bend + wander) * np.sin(way / 6.0), np.zeros(50)])

    def values(tracks: list[np.ndarray], lesson: list[Run]) -> list[float]:
        pose = np.array(tracks)
        n = len(pose)
        table = {"success": np.ones(n, bool), "seed": np.arange(n)}
        rollout = Rollout(
            np.arange(n), np.full(n, 49), np.full(n, "success"), pose, pose[:, 1:, :2], pose, np.zeros(n)
        )
        flown = Flown({(named(20), "standard"): [(table, rollout)]}, [lesson], None, load_boat("swamp"))
        found = not_copied(Claims(pilot="x"), flown)
        return [float(np.exp(np.nanmean(one.values))) for one in found]

    kind, copied = [], []
    for _ in range(20):
        taught = [track() for _ in range(20)]
        columns = [
            dict(zip(("north", "east", "heading", "time"), [*one.T, way], strict=True)) for one in taught
        ]
        lesson = [Run(str(i), column) for i, column in enumerate(columns)]
        kind.append(values([track() for _ in range(30)], lesson))
        copied.append(values([one + 1e-3 for one in taught], lesson))
    assert np.exp(np.log(kind).mean(axis=0)) == pytest.approx([1.0, 1.0], abs=0.15)
    assert max(near for near, _ in copied) < 0.4
    assert np.mean([apart for _, apart in copied]) == pytest.approx(1.0, abs=0.01)
