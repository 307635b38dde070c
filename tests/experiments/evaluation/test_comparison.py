"""`swamp-rl compare`: the same episodes, training seeds known as such, and nothing unlike compared."""

import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import yaml
from scipy.stats import binomtest
from swamp_rl.experiments.artifacts.result_folders import entrants, find_results, read_result
from swamp_rl.experiments.evaluation.comparison import compare
from swamp_rl.experiments.reports.comparison import report

from swamp_rl.errors import UserError
from tests.support.result_folders import folder_of

KINDS = (("one", "reservoir"), ("two", "ppo"))


def test_pilots_of_two_folders_are_paired_by_episode(tmp_path: Path) -> None:
    a, b = np.arange(60) < 50, np.arange(60) % 2 == 0
    one = folder_of(tmp_path / "one", {"reservoir": a})
    two = folder_of(tmp_path / "two", {"ppo": b})
    found = compare([one, two])
    row = next(r for r in found["differences"] if r["quantity"] == "success")
    assert (row["a"], row["b"], row["n"]) == ("reservoir", "ppo", 60)
    assert row["value"] == pytest.approx(50 / 60 - 0.5)
    only_a, only_b = int((a & ~b).sum()), int((b & ~a).sum())
    assert row["p"] == pytest.approx(binomtest(only_a, only_a + only_b).pvalue)
    assert row["p_corrected"] >= row["p"]
    assert found["comparisons"] == 4


def test_costs_that_differ_by_rounding_are_equal(tmp_path: Path) -> None:
    one, two = (folder_of(tmp_path / name, {pilot: np.ones(30, bool)}) for name, pilot in KINDS)
    costs = pq.read_table(one / "episodes.parquet").to_pydict()
    exported = np.asarray(costs["energy"]) * (1.0 + 3e-7 * np.random.default_rng(0).random(30))
    changed_costs = costs | {"energy": exported, "pilot": ["ppo"] * 30}
    pq.write_table(pa.table(changed_costs), two / "episodes.parquet")
    (row,) = (row for row in compare([one, two])["differences"] if row["quantity"] == "energy")
    assert (row["value"], row["low"], row["high"], row["p"]) == (0.0, 0.0, 0.0, 1.0)


def test_a_single_shared_episode_bounds_no_cost_and_hardly_a_success(tmp_path: Path) -> None:
    one, two = (folder_of(tmp_path / name, {pilot: np.ones(1, bool)}) for name, pilot in KINDS)
    found = compare([one, two])
    of = {row["quantity"]: row for row in found["differences"]}
    assert of["success"]["low"] < -0.5 and of["success"]["high"] > 0.5
    assert of["time"]["value"] is not None and (of["time"]["low"], of["time"]["high"]) == (None, None)
    (line,) = (line for line in report(found).splitlines() if "| time [s] |" in line)
    assert " to " not in line and "nan" not in line


def test_energy_per_metre_is_compared_where_every_result_has_it(tmp_path: Path) -> None:
    won = np.ones(30, bool)
    one, two = (folder_of(tmp_path / name, {pilot: won}, electric=True) for name, pilot in KINDS)
    old = folder_of(tmp_path / "old", {"ppo": won})
    found = compare([one, two])
    (row,) = (row for row in found["differences"] if row["quantity"] == "energy_per_metre")
    assert row["n"] == 30
    assert "electric [J/m]" in report(found)
    assert "energy_per_metre" not in {row["quantity"] for row in compare([one, old])["differences"]}


def test_folders_of_training_seeds_are_one_pilot_with_that_many_seeds(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    for seed in range(5):
        folder_of(
            tmp_path / f"seed-{seed}", {"reservoir": rng.random(40) < 0.9, "ppo": rng.random(40) < 0.6}, seed
        )
    found = compare([tmp_path])
    assert [(p["name"], p["seeds"]) for p in found["pilots"]] == [("reservoir", 5), ("ppo", 5)]
    by_seed = found["pilots"][0]["levels"]["calm"]["by_seed"]
    middle = np.sort(by_seed)[1:4]
    assert found["pilots"][0]["levels"]["calm"]["success"]["value"] == pytest.approx(middle.mean())
    assert found["improvement"][0]["value"] == 1.0


def test_pilots_of_one_folder_that_differ_in_seeds_only_are_one_training_method(tmp_path: Path) -> None:
    won = {"ppo": np.ones(20), "clone-1": np.arange(20) < 15, "clone-2": np.arange(20) < 12}
    folder = folder_of(tmp_path / "one", won, seeds={"clone-1": 1, "clone-2": 2})
    found = compare([folder])
    assert [(p["name"], p["seeds"]) for p in found["pilots"]] == [("ppo", 1), ("clone", 2)]
    assert found["pilots"][1]["levels"]["calm"]["by_seed"] == [0.75, 0.6]
    assert {(row["a"], row["b"]) for row in found["differences"]} == {("ppo", "clone")}
    assert found["notes"] == []


def test_pilots_of_one_folder_with_the_same_plan_and_seed_keep_their_names(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "one", {"clone-1": np.ones(20), "clone-2": np.arange(20) < 12})
    assert [one.label for one in entrants([read_result(folder)])] == ["clone-1", "clone-2"]


def test_a_pilot_of_other_options_is_another_pilot_and_named_by_its_folder(tmp_path: Path) -> None:
    a = folder_of(tmp_path / "stiff", {"reservoir": np.ones(20)}, ridge=30.0)
    b = folder_of(tmp_path / "loose", {"reservoir": np.zeros(20)}, ridge=0.3)
    names = [one.label for one in entrants([read_result(a), read_result(b)])]
    assert names == ["reservoir (stiff)", "reservoir (loose)"]


def test_a_pilot_that_started_from_another_is_another_pilot_where_that_was(tmp_path: Path) -> None:
    results = []
    for name, ridge in (("stiff", 30.0), ("loose", 0.3)):
        folder = folder_of(tmp_path / name, {"ppo": np.ones(20), "reservoir": np.ones(20)})
        file = folder / "config" / "experiment.yaml"
        experiment = yaml.safe_load(file.read_text())
        experiment["pilots"]["ppo"]["options"] = {"warm_start": "reservoir"}
        experiment["pilots"]["reservoir"]["options"]["ridge"] = ridge
        file.write_text(yaml.safe_dump(experiment))
        results.append(read_result(folder))
    assert sum(one.pilot == "ppo" for one in entrants(results)) == 2


def test_a_copied_folder_counts_once(tmp_path: Path) -> None:
    for name in ("a", "b"):
        folder_of(tmp_path / name, {"reservoir": np.arange(20) < 15, "ppo": np.ones(20)})
    found = compare([tmp_path])
    assert [pilot["seeds"] for pilot in found["pilots"]] == [1, 1]
    assert found["notes"] == [
        f"{tmp_path / 'b'}: reservoir, ppo did the same, in every shared episode, as in a result named "
        "earlier: counted once."
    ]


def test_a_pilot_that_was_evaluated_again_in_other_episodes_is_the_same_pilot(tmp_path: Path) -> None:
    did = np.arange(40) < 25
    whole = folder_of(tmp_path / "whole", {"reservoir": did[:30], "ppo": np.ones(30)})
    part = folder_of(tmp_path / "part", {"reservoir": did[20:], "ppo": np.ones(20)}, first=120)
    for asked in ([whole, part], [part, whole]):
        found = compare(asked)
        assert [pilot["seeds"] for pilot in found["pilots"]] == [1, 1]
        assert found["levels"] == {"calm": 10} and found["comparisons"] == 4
    (reservoir, _) = (one for one in entrants([read_result(whole), read_result(part)]))
    (table,) = reservoir.tables("calm")
    assert sorted(table["seed"]) == list(range(100, 140))
    assert table["success"][np.argsort(table["seed"])].tolist() == did.tolist()


def test_the_same_seeds_with_other_doings_are_reported(tmp_path: Path) -> None:
    folder_of(tmp_path / "a", {"reservoir": np.ones(20)})
    folder_of(tmp_path / "b", {"reservoir": np.zeros(20)})
    with pytest.raises(UserError, match="did otherwise than in"):
        compare([tmp_path])


def changed(folder: Path, **keys: object) -> Path:
    """The folder, with other keys in its experiment."""
    file = folder / "config" / "experiment.yaml"
    file.write_text(yaml.safe_dump(yaml.safe_load(file.read_text()) | keys))
    return folder


def test_pilots_that_learned_by_another_reward_are_two_pilots(tmp_path: Path) -> None:
    changed(folder_of(tmp_path / "a", {"ppo": np.ones(20)}), reward={"time": 0.02})
    changed(folder_of(tmp_path / "b", {"ppo": np.zeros(20)}), reward={"time": 0.5})
    assert [pilot["name"] for pilot in compare([tmp_path])["pilots"]] == ["ppo (a)", "ppo (b)"]


def test_a_term_of_weight_0_is_no_other_reward(tmp_path: Path) -> None:
    changed(folder_of(tmp_path / "a", {"ppo": np.ones(20)}), reward={"time": 0.02})
    changed(folder_of(tmp_path / "b", {"ppo": np.ones(20)}), reward={"time": 0.02, "energy": 0.0})
    assert [pilot["name"] for pilot in compare([tmp_path])["pilots"]] == ["ppo"]


def test_data_and_reward_that_a_pilot_does_not_learn_from_make_no_other_pilot(tmp_path: Path) -> None:
    won = {"ppo": np.ones(20), "reservoir": np.ones(20)}
    changed(folder_of(tmp_path / "a", won), data={"folder": "monday"})
    changed(folder_of(tmp_path / "b", won), data={"folder": "tuesday"})
    names = ["ppo", "reservoir (a)", "reservoir (b)"]
    assert sorted(pilot["name"] for pilot in compare([tmp_path])["pilots"]) == names


@pytest.mark.parametrize("key, value", [("time_limit", 60.0), ("bounds", {"north": 40.0}), ("depth", 2.0)])
def test_other_limits_of_the_course_are_refused_in_one_line(tmp_path: Path, key: str, value: object) -> None:
    folder_of(tmp_path / "a", {"reservoir": np.ones(20)})
    changed(folder_of(tmp_path / "b", {"ppo": np.ones(20)}), **{key: value})
    with pytest.raises(UserError, match=f"another {key} than in"):
        compare([tmp_path])


def test_a_stored_pilot_is_the_one_that_was_trained(tmp_path: Path) -> None:
    trained = folder_of(tmp_path / "trained", {"reservoir": np.ones(20)})
    (trained / "results.json").write_text(json.dumps({"pilots": {"reservoir": {"sha256": "ab"}}}))
    again = []
    for name, place in (("first", "pilots/reservoir"), ("second", "elsewhere/reservoir")):
        plan = {"kind": "stored", "options": {"folder": place, "sha256": "ab"}}
        folder = folder_of(tmp_path / name, {"reservoir": np.ones(20)})
        again.append(changed(folder, pilots={"reservoir": plan}, data={"folder": place}))
    for asked in ([trained, *again], again):
        assert [(one["name"], one["seeds"]) for one in compare(asked)["pilots"]] == [("reservoir", 1)]


def test_a_folder_that_holds_anything_in_place_of_mappings_is_compared_all_the_same(tmp_path: Path) -> None:
    odd = changed(folder_of(tmp_path / "odd", {"ppo": np.ones(20)}), reward=[1], data="x", bounds=[2])
    plans = {"ppo": {"kind": ["ppo"]}, "net": {"kind": "stored", "options": {"sha256": ["a"]}}}
    changed(odd, pilots=plans, bounds={})
    (odd / "results.json").write_text(json.dumps({"pilots": [1]}))
    assert [one["name"] for one in compare([odd])["pilots"]] == ["ppo"]
    (odd / "results.json").write_text(json.dumps({"pilots": {"ppo": 3, "net": {"sha256": {}}}}))
    assert [one["name"] for one in compare([odd])["pilots"]] == ["ppo"]


def test_other_courses_are_refused_in_one_line(tmp_path: Path) -> None:
    folder_of(tmp_path / "a", {"reservoir": np.ones(20)})
    folder_of(tmp_path / "b", {"ppo": np.ones(20)}, course="elsewhere")
    with pytest.raises(UserError, match="another course than in"):
        compare([tmp_path])


def test_only_common_episodes_count_and_it_is_said(tmp_path: Path) -> None:
    a = folder_of(tmp_path / "a", {"reservoir": np.ones(30)})
    b = folder_of(tmp_path / "b", {"ppo": np.arange(30) < 10}, first=120)
    found = compare([a, b])
    assert found["levels"] == {"calm": 10}
    assert found["notes"][0] == "calm: only the 10 episodes that all have driven, of 30."
    assert found["notes"][0] in report(found)
    assert found["pilots"][1]["levels"]["calm"]["success"]["value"] == 1.0


def test_pilots_that_are_not_named_limit_no_episodes_and_have_no_notes(tmp_path: Path) -> None:
    folder_of(tmp_path / "a", {"reservoir": np.ones(30), "ppo": np.ones(30)})
    folder_of(tmp_path / "b", {"ppo": np.ones(30)}, first=120)
    folder_of(tmp_path / "c", {"reservoir": np.ones(30)})
    assert compare([tmp_path])["levels"] == {"calm": 10}
    found = compare([tmp_path], only=["reservoir"])
    assert found["levels"] == {"calm": 30}
    assert found["folders"] == [str(tmp_path / "a"), str(tmp_path / "c")]
    (note,) = found["notes"]
    assert note.startswith(f"{tmp_path / 'c'}: reservoir did the same")


def test_no_common_episode_is_refused(tmp_path: Path) -> None:
    a = folder_of(tmp_path / "a", {"reservoir": np.ones(5)})
    b = folder_of(tmp_path / "b", {"ppo": np.ones(5)}, first=900)
    with pytest.raises(UserError, match="no episode that all have driven"):
        compare([a, b])


def test_never_arriving_leaves_costs_open_and_json_strict(tmp_path: Path) -> None:
    folder_of(tmp_path / "a", {"reservoir": np.zeros(20), "ppo": np.ones(20)})
    found = compare([tmp_path])
    json.dumps(found, allow_nan=False)
    time = next(row for row in found["differences"] if row["quantity"] == "time")
    assert (time["value"], time["p"], time["p_corrected"]) == (None, None, None)
    assert found["comparisons"] == 1
    assert "–" in report(found)


def test_the_same_seed_draws_the_same_comparison(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    folder_of(tmp_path / "a", {"reservoir": rng.random(50) < 0.5, "ppo": rng.random(50) < 0.7})
    assert compare([tmp_path], seed=3) == compare([tmp_path], seed=3)
    assert compare([tmp_path], seed=3) != compare([tmp_path], seed=4)


def test_a_folder_without_episodes_and_a_broken_one_are_reported(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"no episodes.parquet"):
        find_results([tmp_path])
    broken = folder_of(tmp_path / "a", {"ppo": np.ones(5)})
    (broken / "episodes.parquet").write_bytes(b"PAR1 but no more")
    with pytest.raises(UserError, match="not a readable Parquet"):
        compare([broken])
