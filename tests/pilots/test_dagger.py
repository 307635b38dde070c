"""DAgger: the learner drives, and the expert's levers are what is learned there."""

import numpy as np
import pytest
from pydantic import ValidationError
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.hindsight import with_gates

from swamp_rl.boat import load_boat
from swamp_rl.course import load_course
from swamp_rl.evaluation import drive
from swamp_rl.pilots import Pilot
from swamp_rl.pilots.dagger import DaggerSettings, corrected_runs, fit_dagger, succeeded
from swamp_rl.pilots.record import drive_episodes
from swamp_rl.pilots.reservoir import ReservoirSettings, fit_reservoir
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.runs import Run

pytestmark = pytest.mark.slow

BOAT, COURSE = load_boat("swamp"), load_course("camogli")
FEW = {"learner": {"kind": "reservoir", "units": 60}, "rounds": 2, "runs": 2, "trials": 0}


def boats(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
    return GatesVectorEnv(n, disturbances="standard", observation=senses)


def look(run: Run) -> Run:
    return with_gates(run, COURSE)


@pytest.fixture(scope="module")
def demonstrated() -> list[Run]:
    """Four runs of the scripted pilot at `standard`."""
    pilot = ScriptedPilot(0)
    pilot.reset(4)
    return [
        look(run) for run in drive_episodes(boats(4, pilot.senses), pilot, BOAT, 2**31 + np.arange(4), 0.1)
    ]


def test_the_learner_drives_and_the_levers_are_what_the_expert_would_have_done(
    demonstrated: list[Run],
) -> None:
    learner = fit_reservoir(demonstrated, ReservoirSettings(units=60))
    seeds = 2**31 + 100 + np.arange(3)
    runs = corrected_runs(learner, ScriptedPilot(7), boats, BOAT, seeds, 0.1)
    flown = drive(learner, boats, seeds)
    expert, watched = ScriptedPilot(7), boats(3, ScriptedPilot(7).senses)
    observation, _ = watched.reset(options={"episodes": seeds})
    expert.reset(3)
    steps = min(len(run.time) for run in runs) - 1
    for t in range(steps):
        result = expert.act(observation)
        np.testing.assert_allclose([run.joypad[t] for run in runs], result)
        observation = watched.step(flown.commands[:, t])[0]
    for i, run in enumerate(runs):
        np.testing.assert_allclose(run.pose[:, :2], flown.track(i)[:, :2], atol=1e-9)
        np.testing.assert_array_equal(run.joypad[-1], run.joypad[-2])


def test_the_same_seed_gives_the_same_pilot_and_another_one_another(demonstrated: list[Run]) -> None:
    first, second, other = (
        fit_dagger(
            demonstrated, boats, BOAT, look, DaggerSettings.model_validate(FEW | {"seed": seed})
        ).weights()
        for seed in (0, 0, 1)
    )
    np.testing.assert_array_equal(first["Wout"], second["Wout"])
    assert (first["W"] != other["W"]).any()


def test_the_expert_judges_distances_by_the_length_of_the_boat(demonstrated: list[Run]) -> None:
    driven: dict[float, Run] = {}
    for length in (BOAT.length, 4.0 * BOAT.length):

        def noted(run: Run, length: float = length) -> Run:
            driven[length] = run
            return look(run)

        settings = DaggerSettings.model_validate(FEW | {"rounds": 1, "runs": 1})
        fit_dagger(demonstrated, boats, BOAT.model_copy(update={"length": length}), noted, settings)
    short, long = driven.values()
    np.testing.assert_array_equal(short.pose, long.pose)
    assert np.mean(short.joypad[:, 1] != long.joypad[:, 1]) > 0.1


def test_a_boat_length_of_the_experts_own_is_refused() -> None:
    with pytest.raises(ValidationError, match="is that of the boat; leave it out"):
        DaggerSettings.model_validate({"expert": {"boat_length": 3.0}})


def test_it_tells_how_far_it_is_and_learns_from_as_many_runs_as_it_says(demonstrated: list[Run]) -> None:
    looked: list[str] = []

    def counted(run: Run) -> Run:
        looked.append(run.name)
        return look(run)

    heard: list[float] = []
    fit_dagger(demonstrated, boats, BOAT, counted, DaggerSettings.model_validate(FEW), tick=heard.append)
    assert heard == [0.5, 1.0]
    assert len(set(looked)) == 4


def test_corrections_teach_what_good_runs_do_not(demonstrated: list[Run]) -> None:
    """With one run to begin with, the learner soon leaves the gates' way; corrected, it finds back."""
    one = demonstrated[:1]
    settings = DaggerSettings(rounds=5, runs=4, trials=0, seed=1)
    seeds = np.arange(1_500_000, 1_500_060)
    corrected = fit_dagger(one, boats, BOAT, look, settings)
    before, after = (
        (drive(pilot, boats, seeds).outcome == "success").mean()
        for pilot in (fit_reservoir(one, ReservoirSettings(seed=1)), corrected)
    )
    assert after > before + 0.1


def test_settings_come_back_from_what_is_written_out_and_have_one_seed() -> None:
    settings = DaggerSettings.model_validate({"learner": {"kind": "gru", "epochs": 5}, "seed": 4})
    assert DaggerSettings.model_validate(settings.model_dump(mode="json")) == settings
    assert "seed" not in settings.model_dump(mode="json")["learner"]
    with pytest.raises(ValidationError, match="give it beside learner"):
        DaggerSettings.model_validate({"learner": {"kind": "gru", "seed": 4}})


def test_of_the_rounds_learners_the_one_that_succeeds_most_is_kept(demonstrated: list[Run]) -> None:
    """The last learner, without trials, does worse in the very trials that the kept one was chosen by."""
    settings = DaggerSettings.model_validate(FEW | {"rounds": 4, "runs": 1, "seed": 2})
    seeds = np.random.default_rng(2).integers(2**31, 2**32, 40)
    points: dict[int, list[tuple[int, dict[str, float]]]] = {0: [], 40: []}

    def fitted(trials: int) -> Pilot:
        asked = settings.model_copy(update={"trials": trials})
        return fit_dagger(
            demonstrated,
            boats,
            BOAT,
            look,
            asked,
            log=lambda *point: points[trials].append((point[0], dict(point[1]))),
        )

    last, kept = fitted(0), fitted(40)
    assert points[0] == [(i, {"runs": len(demonstrated) + i}) for i in range(5)]
    assert [values["runs"] for _, values in points[40]] == [values["runs"] for _, values in points[0]]
    assert max(values["success"] for _, values in points[40]) == succeeded(kept, boats, seeds) / 40
    assert succeeded(kept, boats, seeds) == (drive(kept, boats, seeds).outcome == "success").sum()
    assert succeeded(kept, boats, seeds) >= succeeded(last, boats, seeds)
