"""The scripted pilot drives the way the thesis says that people did (7.3.3)."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv

from swamp_rl.errors import UserError
from swamp_rl.evaluation.rollout import Rollout, drive
from swamp_rl.files import validated
from swamp_rl.pilots.scripted import SKILLS, Habits, ScriptedPilot

SENSES = ScriptedPilot(0).senses
STEADY = Habits(aim_spread=0.0, guess_interval=1e9, hesitation_interval=1e9, messy=0.0, gentle=0.0)


def driven(level: str | Path, habits: Habits | None = None, n: int = 64) -> Rollout:
    pilot = ScriptedPilot(3, habits)
    return drive(
        pilot, lambda n, senses: GatesVectorEnv(n, disturbances=level, observation=senses), np.arange(n)
    )


def scene(n: int = 1, **values: float) -> np.ndarray:
    """Observation (n, 7) of boats at rest, the gate 8 m ahead, but for the values given."""
    found = dict.fromkeys(SENSES, 0.0) | {"gate_ahead": 8.0, "gate_cos": 1.0} | values
    return np.tile([found[name] for name in SENSES], (n, 1))


@pytest.fixture(scope="module")
def calm() -> Rollout:
    return driven("calm")


def test_most_runs_succeed_in_calm_water_and_some_fail_when_it_is_severe(calm: Rollout) -> None:
    assert np.mean(calm.outcome == "success") > 0.9
    assert 0.2 < np.mean(driven("severe").outcome == "success") < 0.9


def test_the_more_skilled_the_driver_the_more_runs_succeed() -> None:
    rates = [np.mean(driven("severe", SKILLS[skill], 200).outcome == "success") for skill in SKILLS]
    assert list(SKILLS) == ["novice", "usual", "expert"]
    assert rates[0] + 0.05 < rates[1] < rates[2] - 0.05


def test_full_throttle_and_the_ends_of_the_steering_lever_are_what_it_uses(calm: Rollout) -> None:
    levers = np.concatenate([calm.levers(i) for i in range(len(calm.seeds))])
    assert np.mean(levers[:, 0] == 1.0) > 0.9
    assert np.isin(levers[:, 0], (0.0, 1.0)).all()
    assert np.mean(np.isin(levers[:, 1], (-1.0, 0.0, 1.0))) > 0.9
    assert np.mean(levers[:, 1] != 0.0) > 0.2


def test_a_boat_that_starts_beyond_a_gate_goes_round_for_it(tmp_path: Path) -> None:
    level = tmp_path / "beyond.yaml"
    level.write_text("start: {north: 11.0}\n", encoding="utf-8")
    assert np.mean(driven(level, STEADY, 16).outcome == "success") > 0.8


def test_a_range_whose_ends_are_exchanged_is_refused() -> None:
    with pytest.raises(UserError, match=r"a\.yaml: reaction: the first number is above the second"):
        validated("a.yaml", Habits, {"reaction": [1.0, 0.1]})


def test_what_is_seen_is_acted_on_after_the_reaction_time() -> None:
    pilot = ScriptedPilot(0, STEADY.model_copy(update={"reaction": (0.3, 0.3)}))
    pilot.reset(1)
    angles = [pilot.act(scene(gate_starboard=0.0))[0, 1] for _ in range(10)]
    angles += [pilot.act(scene(gate_starboard=6.0))[0, 1] for _ in range(6)]
    assert angles == [0.0] * 13 + [1.0] * 3


def test_a_mirrored_scene_is_answered_by_mirrored_levers() -> None:
    mirror = np.array([1.0, -1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    seen = np.random.default_rng(0).normal(size=(30, 50, 7)) * [0.5, 0.1, 0.2, 8.0, 4.0, 1.0, 1.0]
    one, other = ScriptedPilot(5, STEADY), ScriptedPilot(5, STEADY)
    for pilot in (one, other):
        pilot.reset(50)
    for observation in seen:
        levers, mirrored = one.act(observation), other.act(observation * mirror)
        np.testing.assert_array_equal(levers, mirrored * [1.0, -1.0])


def test_a_boat_is_driven_alike_whoever_else_is_driven() -> None:
    few, many = ScriptedPilot(1), ScriptedPilot(1)
    few.reset(2)
    many.reset(9)
    for t in range(300):
        side = 5.0 * np.sin(0.1 * t)
        alike = many.act(scene(9, gate_starboard=side))[:2]
        np.testing.assert_array_equal(few.act(scene(2, gate_starboard=side)), alike)


def test_each_run_and_each_seed_has_habits_of_its_own() -> None:
    def driven_by(seed: int, runs: int) -> np.ndarray:
        pilot = ScriptedPilot(seed)
        pilot.reset(4)
        for _ in range(runs):
            pilot.reset_boats(np.ones(4, dtype=bool))
        return np.array([pilot.act(scene(4, gate_starboard=5.0 * np.sin(0.1 * t))) for t in range(300)])

    np.testing.assert_array_equal(driven_by(1, 0), driven_by(1, 0))
    assert (driven_by(1, 0) != driven_by(1, 1)).any()
    assert (driven_by(1, 0) != driven_by(2, 0)).any()


def test_wrong_guesses_push_the_lever_the_other_way() -> None:
    guessing = STEADY.model_copy(update={"guess_interval": 2.0, "guess_duration": (1.0, 1.0)})
    pilot = ScriptedPilot(0, guessing)
    pilot.reset(20)
    angles = np.array([pilot.act(scene(20, gate_starboard=6.0))[:, 1] for _ in range(300)])[10:]
    assert set(np.unique(angles)) == {-1.0, 1.0}
    assert 0.15 < np.mean(angles < 0.0) < 0.6
