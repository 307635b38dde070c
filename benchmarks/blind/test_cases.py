"""The blind cases themselves: drawn from the seed alone, whole as files, and silent about the truth."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from swamp_rl.experiments.synthetic.cases import (
    EACH_RUN,
    EFFECTS,
    LEVELS,
    ONE_PURPOSE,
    ROUGH,
    TRIPLE,
    draw_case,
    voyages,
    write_case,
)

from benchmarks.blind import rough_simulator as rough
from benchmarks.blind.cases import drawn, written
from benchmarks.blind.score import is_false_positive, judged
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.run_set import read_run_set
from swamp_rl.criticism.model.candidates import selectors
from swamp_rl.effects import LIBRARY

pytestmark = pytest.mark.numerical

BOAT = load_boat("swamp")


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("kind", ["single", "outside"])
def test_a_case_reads_as_runs_and_its_files_do_not_tell_the_truth(
    level: str, kind: str, tmp_path: Path
) -> None:
    rng = np.random.default_rng(3)
    case = draw_case(rng, level, kind)
    write_case(case, rng, tmp_path / "data", tmp_path / "truth.json", runs=2, seconds=30.0)
    trials = read_run_set(tmp_path / "data", BOAT)
    assert trials.measured.shape == (2, 301, 6)
    assert 0 < np.isnan(trials.measured[:, :, 0]).mean() < 0.1  # dropped samples
    assert np.isfinite(trials.measured[:, :, 3]).any() == (level != "B")
    assert (np.abs(trials.commands[:, :, 6:]).max() == 0.0) == (level == "C")  # stern off in gate runs
    written = yaml.safe_load((tmp_path / "data" / "dataset.yaml").read_text())
    assert all(set(run) == {"file", "rows"} for run in written["runs"])
    assert (written["mass"], written["vehicle"]) == (BOAT.mass, "swamp")
    assert {path.name for path in (tmp_path / "data").iterdir()} == {"dataset.yaml", "run_0.csv", "run_1.csv"}
    assert json.loads((tmp_path / "truth.json").read_text())["effects"] == case.effects


def test_the_seed_alone_decides_a_case(tmp_path: Path) -> None:
    tables = []
    for name in ("one", "two"):
        rng = np.random.default_rng(11)
        write_case(draw_case(rng, "A", "pair"), rng, tmp_path / name, tmp_path / f"{name}.json", 1, 20.0)
        tables.append((tmp_path / name / "run_0.csv").read_bytes())
    assert tables[0] == tables[1]


def test_every_effect_that_the_library_can_be_guilty_of_is_hidden() -> None:
    by_chance = {"gusts", "thruster_kick"}  # somebody else's doing, not the boat's
    of_no_name = {"force_curve"}  # what is left where none of the others explains it
    nuisance = {"hull_coefficients", "wind_coefficients"}
    of_episodes = {name for name, effect in LIBRARY.items() if effect.battery}
    boat = load_boat("swamp")
    not_of_the_boat = {
        name for name, effect in LIBRARY.items() if effect.needs and not selectors(effect, boat)
    }
    assert not_of_the_boat == {"throttle_reversed", "rudder_hull_force"}
    assert set(EFFECTS) == set(LIBRARY) - by_chance - of_no_name - nuisance - of_episodes - not_of_the_boat


@pytest.mark.parametrize("number", range(4))
def test_at_level_e_each_run_has_a_weather_of_its_own_alone_or_beside_one_effect(number: int) -> None:
    case, rng, _ = drawn(number, EACH_RUN)
    assert len(case.effects) == (number % 4 > 0)
    assert len({json.dumps(run) for run in case.by_run}) == 5
    (weather,) = {effect["effect"] for run in case.by_run for effect in run}
    field = {"wind": "wind_speed", "current": "current_north"}[weather]
    records = [voyage.record for voyage in voyages(case, rng, 5, 1.0)]
    assert len({float(record[field][0]) for record in records}) == 5
    names = [*(effect["effect"] for effect in case.effects), weather]
    assert judged(vars(case), answer("cause", names))["right"]
    assert not judged(vars(case), answer("cause", names[1:]))["right"]


def test_at_level_t_three_effects_of_different_purpose_are_hidden() -> None:
    cases = [drawn(number, TRIPLE)[0] for number in range(40)]
    assert all(len({one["effect"] for one in case.effects}) == 3 for case in cases)
    assert not any(set(pair) <= set(case.names) for case in cases for pair in ONE_PURPOSE)
    truth = vars(cases[0])
    assert judged(truth, answer("cause", cases[0].names))["right"]
    assert not judged(truth, answer("cause", cases[0].names[:2]))["right"]


def test_the_other_simulator_without_its_errors_is_near_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    case = draw_case(np.random.default_rng(0), ROUGH, "single", ("thruster_gain",), 1.0)
    first = voyages(case, np.random.default_rng(5), 2, 20.0)
    rough_ones = rough.rough_voyages(case, np.random.default_rng(5), 2, 20.0)
    monkeypatch.setattr(rough, "curves_in_error", lambda rng, thrusters: np.zeros((3 + thrusters, 3)))
    monkeypatch.setattr(rough, "process_noise", lambda rng, rows: np.zeros((rows, 3)))
    exact = rough.rough_voyages(case, np.random.default_rng(5), 2, 20.0)
    for one, other in zip(first, exact, strict=True):
        assert 0.0 < np.hypot(*(one.track - other.track)[:, :2].T).max() < 0.1
        assert np.array_equal(one.record, other.record)
    assert not np.allclose(rough_ones[0].track, first[0].track, atol=0.1)


def test_a_curve_is_off_by_three_percent_and_right_on_average() -> None:
    curve = rough.curves_in_error(np.random.default_rng(2), 4)[1]
    period = 2.0 * np.pi / curve[0]
    factors = np.array([rough.in_error(x, curve) for x in np.arange(200) * period / 200])
    assert factors.mean() == pytest.approx(1.0, abs=1e-9)
    assert factors.std() == pytest.approx(0.03, rel=1e-6)
    noise = rough.process_noise(np.random.default_rng(3), 40_000)
    np.testing.assert_allclose(noise.std(axis=0), rough.PROCESS_NOISE, rtol=0.15)


def test_a_case_of_the_other_simulator_is_right_where_nothing_else_is_named() -> None:
    case, _, _ = drawn(0, ROUGH)
    truth = vars(case)
    assert drawn(2, ROUGH)[0].kind == "clean"
    assert judged(truth, answer("unexplained", case.names))["right"]
    assert judged(truth, answer("cause", case.names))["right"]
    assert not judged(truth, answer("unexplained", [*case.names, "mass"]))["right"]
    clean = truth | {"kind": "clean", "effects": []}
    assert judged(clean, answer("unexplained", []))["right"]
    alarm = judged(clean, answer("unexplained", ["mass"]))
    assert not alarm["right"] and is_false_positive(alarm)


def answer(verdict: str, causes: list[str], sets: list[list[str]] | None = None) -> dict[str, object]:
    named = [{"effect": name, "thruster": "bs", "parameters": {}} for name in causes]
    return {"verdict": verdict, "causes": named, "indistinguishable": sets or [], "elapsed_s": 1.0}


def test_the_judge_wants_every_name_and_no_more() -> None:
    truth = {"effects": [{"effect": "mass"}], "level": "A", "kind": "single", "size": 1.0, "outside": None}
    truth["hull"] = {}
    assert judged(truth, answer("cause", ["mass"]))["right"]
    assert not judged(truth, answer("cause", ["mass", "wind"]))["right"]
    assert not judged(truth, answer("unexplained", ["mass"]))["right"]
    assert judged(truth, answer("indistinguishable", ["wind"], [["wind", "mass"]]))["right"]
    assert not judged(truth, answer("indistinguishable", [], [["wind", "mass", "current", "waves"]]))["right"]
    assert not judged(truth, None)["right"]
    clean = truth | {"effects": [], "kind": "clean"}
    assert judged(clean, answer("nothing_wrong", []))["right"]
    assert not judged(clean, answer("cause", ["mass"]))["right"]


def test_no_effect_is_hidden_that_no_recorded_channel_shows(tmp_path: Path) -> None:
    """Number 17027 draws a gyro's bias first, and instruments without a gyro."""
    data, truth = written(17027, "X", tmp_path)
    stored = json.loads(truth.read_text())
    header = (data / "run_0.csv").read_text().splitlines()[0].split(",")
    hidden = [effect["effect"] for effect in stored["effects"]]
    assert "gyro_bias" not in hidden or "yaw_rate" in header


def test_no_exchange_of_thrusters_is_hidden_whose_commands_are_equal(tmp_path: Path) -> None:
    """Number 27004 draws an exchange of the two stern thrusters first."""
    _, truth = written(27004, "X", tmp_path)
    exchanged = [
        e["thruster"] for e in json.loads(truth.read_text())["effects"] if LIBRARY[e["effect"]].swaps
    ]
    assert not any(set(pair) in ({"bs", "bp"}, {"ss", "sp"}) for pair in exchanged)


def test_no_dead_zone_is_hidden_that_its_throttle_never_leaves(tmp_path: Path) -> None:
    """Number 29014 draws such a dead zone first, which is a thruster without thrust."""
    data, truth = written(29014, "X", tmp_path)
    outside = json.loads(truth.read_text())["outside"]
    if outside and outside["what"] == "dead_zone":
        throttle = np.concatenate(
            [
                np.genfromtxt(run, delimiter=",", names=True)[f"throttle_{outside['thruster']}"]
                for run in sorted(data.glob("run_*.csv"))
            ]
        )
        assert (throttle > outside["below"]).mean() > 0.05
