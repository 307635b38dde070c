"""Driving episodes in a batch, and the rows and runs that come of it."""

from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from swamp_rl.envs.batched import GatesVectorEnv

from swamp_rl.boat import load_boat
from swamp_rl.evaluation import Rollout, differences, drive, episode_table, summary, write_episodes
from swamp_rl.evaluation.rollout import Array

STEP = 0.1


class Steady:
    """Holds the levers where they are put; remembers with how many boats it was begun."""

    senses = ("north", "east")

    def __init__(self, throttle: float, angle: float) -> None:
        self.levers = (throttle, angle)

    def reset(self, n: int) -> None:
        self.n = n

    def keep(self, boats: Array) -> None:
        self.n = len(boats)

    def act(self, observation: Array) -> Array:
        assert observation.shape == (self.n, 2)
        return np.tile(self.levers, (self.n, 1))


def boats(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
    return GatesVectorEnv(n, disturbances="standard", observation=senses, step=STEP)


@pytest.fixture(scope="module")
def circling() -> Rollout:
    return drive(Steady(0.8, 0.2), boats, np.arange(100, 112))


def test_an_episode_is_the_same_alone_and_among_others(circling: Rollout) -> None:
    for i in (0, 7):
        alone = drive(Steady(0.8, 0.2), boats, circling.seeds[i : i + 1])
        assert alone.outcome[0] == circling.outcome[i]
        assert np.array_equal(alone.track(0), circling.track(i))


def test_an_episode_ends_where_its_boat_first_ended(circling: Rollout) -> None:
    assert set(circling.outcome) <= {"buoy", "out_of_bounds", "timeout", "success"}
    assert len(set(circling.steps)) > 1
    shortest = int(np.argmin(circling.steps))
    track = circling.track(shortest)
    assert len(track) == circling.steps[shortest] + 1
    # Had the boat been started anew within its track, it would have jumped.
    assert np.hypot(*np.diff(track[:, :2], axis=0).T).max() < 0.3


def test_time_and_energy_of_steady_levers_follow_from_the_boat_file(circling: Rollout) -> None:
    boat = load_boat("swamp")
    table = episode_table(circling, boat, STEP)
    assert table["time"] == pytest.approx(circling.steps * STEP)
    # Two bow thrusters at throttle 0.8 for the whole time; the stern kicks can only add to it.
    thrust = 12.2 * 0.8**2
    power = 2 * thrust**1.5 / (2 * np.sqrt(boat.water_density * 900e-6))
    assert np.all(table["energy"] >= power * table["time"] * (1 - 1e-9))
    assert table["command_change"] == pytest.approx(np.zeros(12))


def test_electric_figures_follow_from_the_throttles_and_the_path(circling: Rollout) -> None:
    boat = load_boat("swamp")
    table = episode_table(circling, boat, STEP)
    i, steps = 4, int(circling.steps[4])
    power = (
        2 * 88.0
        + sum(  # W, by the numbers of the boat file
            9.404 + 2.0237 * (12.2 * throttle**2) ** 1.5 for throttle in circling.throttle[i, :steps].T
        )
    )
    assert table["electric_energy"][i] == pytest.approx(power.sum() * STEP)
    per_metre = table["electric_energy"] / table["path_length"]
    assert table["energy_per_metre"] == pytest.approx(per_metre)
    # two packs of 46800 C at 40 to 32 V, less the reserve of 0.1; the fuller one cannot help the other
    most = 2 * 46800.0 * (36.0 - (32.0 * 0.1 + 4.0 * 0.01))
    assert np.all(table["range"] <= (most - table["electric_energy"]) / per_metre)
    assert np.all(table["range"] > 0.8 * (most - table["electric_energy"]) / per_metre)


def test_a_boat_without_battery_has_no_electric_columns(circling: Rollout) -> None:
    table = episode_table(circling, load_boat("swamp-thesis"), STEP)
    assert not {"electric_energy", "energy_per_metre", "range"} & set(table)
    assert set(summary(table)["mean_of_successes"]) == {"time", "path_length", "command_change", "energy"}


def test_electric_costs_are_summed_up_and_compared_where_both_have_them() -> None:
    a = rows(range(3), [True, True, False], [10.0, 20.0, 5.0])
    b = rows(range(3), [True, True, True], [13.0, 25.0, 50.0])
    electric = a | dict.fromkeys(("electric_energy", "energy_per_metre", "range"), a["time"])
    assert summary(electric)["mean_of_successes"]["energy_per_metre"] == 15.0
    assert "range" not in differences(electric, b, np.random.default_rng(0))
    both = b | dict.fromkeys(("electric_energy", "energy_per_metre", "range"), b["time"])
    assert differences(electric, both, np.random.default_rng(0))["energy_per_metre"].value == -4.0


def test_a_run_made_of_an_episode_has_its_track_levers_and_wrapped_heading(circling: Rollout) -> None:
    run = circling.run(3, "one", STEP)
    assert np.array_equal(run.pose[:, :2], circling.track(3)[:, :2])
    assert np.allclose(np.exp(1j * run.pose[:, 2]), np.exp(1j * circling.track(3)[:, 2]))
    assert run.pose[:, 2].min() > -np.pi and run.pose[:, 2].max() <= np.pi
    assert np.all(run.joypad == (0.8, 0.2))
    assert (run.meta.seed, run.meta.outcome) == (103, circling.outcome[3])


def rows(seeds: range, won: list[bool], time: list[float]) -> dict[str, np.ndarray]:
    cost = np.array(time)
    outcome = np.where(won, "success", "buoy")
    table = {"seed": np.array(seeds), "success": np.array(won), "outcome": outcome, "time": cost}
    return table | {"path_length": cost, "command_change": cost, "energy": cost}


def test_a_summary_averages_costs_over_successes_only() -> None:
    found = summary(rows(range(4), [True, False, True, True], [10.0, 1000.0, 20.0, 30.0]))
    assert found["success_rate"] == 0.75
    assert found["mean_of_successes"]["time"] == 20.0
    assert found["outcomes"] == {"buoy": 1, "success": 3}


def test_a_summary_without_successes_has_no_costs() -> None:
    found = summary(rows(range(2), [False, False], [1.0, 2.0]))
    assert found["success_rate"] == 0.0
    assert found["mean_of_successes"]["energy"] is None


def test_costs_are_compared_where_both_pilots_succeeded() -> None:
    a = rows(range(3), [True, True, False], [10.0, 20.0, 5.0])
    b = rows(range(3), [True, False, True], [13.0, 99.0, 50.0])
    found = differences(a, b, np.random.default_rng(0))
    assert (found["time"].value, found["time"].n) == (-3.0, 1)
    assert (found["success"].value, found["success"].n) == (0.0, 3)


def test_pilots_evaluated_on_other_episodes_are_not_compared() -> None:
    a = rows(range(2), [True, True], [1.0, 1.0])
    with pytest.raises(ValueError, match="same episodes"):
        differences(a, rows(range(1, 3), [True, True], [1.0, 1.0]), np.random.default_rng(0))


def test_the_parquet_file_has_a_row_for_each_pilot_level_and_episode(tmp_path: Path) -> None:
    table = rows(range(3), [True, True, False], [10.0, 20.0, 5.0])
    write_episodes(tmp_path / "episodes.parquet", {("a", "calm"): table, ("b", "severe"): table})
    read = pq.read_table(tmp_path / "episodes.parquet").to_pydict()
    assert list(zip(read["pilot"], read["level"], strict=True)) == [("a", "calm")] * 3 + [("b", "severe")] * 3
    assert read["outcome"][:3] == ["success", "success", "buoy"]
