"""Recorded runs hold what is needed to learn from them and to replay them exactly."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv

from swamp_rl.boat import load_boat
from swamp_rl.effects import apply_effects, parse_effects
from swamp_rl.errors import UserError
from swamp_rl.pilots.demonstrations import choose_runs
from swamp_rl.pilots.record import record_scripted
from swamp_rl.pilots.scripted import Habits
from swamp_rl.runs import Dataset, check_dataset, read_dataset
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.replay import replay
from swamp_rl.simulator.state import ACTUATORS
from swamp_rl.simulator.substeps import substeps_of
from swamp_rl.unfinished import folder_beside

BOAT = load_boat("swamp")


def boats_at(level: str):
    return lambda n, senses: GatesVectorEnv(n, disturbances=level, observation=senses)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    folder = tmp_path_factory.mktemp("recorded") / "data"
    record_scripted(boats_at("standard"), folder, count=6, failed=2, seed=4)
    assert check_dataset(folder) == []
    return read_dataset(folder)


def test_as_many_good_runs_as_asked_are_kept_and_the_failed_ones_are_marked(recorded: Dataset) -> None:
    outcomes = [run.meta.outcome for run in recorded.runs]
    assert outcomes.count("success") == 6
    assert len(outcomes) - 6 == 2
    assert set(outcomes) <= {"success", "buoy", "out_of_bounds", "timeout"}
    assert recorded.meta.source == "scripted"
    assert "no person" in str(recorded.meta.notes)


def test_drivers_of_several_skills_drive_the_same_episodes_and_their_runs_say_whose_they_are(
    recorded: Dataset, tmp_path: Path
) -> None:
    record_scripted(
        boats_at("standard"), tmp_path / "data", count=3, seed=4, skills=("usual", "novice", "expert")
    )
    runs = read_dataset(tmp_path / "data").runs
    by_skill = {skill: choose_runs(runs, None, skill=skill) for skill in ("usual", "novice", "expert")}
    assert [len(chosen) for chosen in by_skill.values()] == [3, 3, 3]
    for ours, alone in zip(by_skill["usual"], recorded.successful[:3], strict=True):
        np.testing.assert_array_equal(ours.joypad, alone.joypad)
    first = {runs_of[0].meta.seed for runs_of in by_skill.values()}
    assert len(first) < 3
    with pytest.raises(UserError, match="skill champion"):
        choose_runs(runs, None, skill="champion")


@pytest.mark.parametrize("failed", [0, 1])
def test_exactly_the_failed_runs_asked_for_are_kept_where_others_failed_meanwhile(
    failed: int, tmp_path: Path
) -> None:
    """Of the first 8 good runs' episodes at this level, 3 or more fail."""
    record_scripted(boats_at("severe"), tmp_path / "data", count=8, failed=failed, seed=4)
    outcomes = [run.meta.outcome for run in read_dataset(tmp_path / "data").runs]
    assert (outcomes.count("success"), len(outcomes)) == (8, 8 + failed)


def test_the_good_runs_are_the_same_however_many_failed_ones_are_kept(
    recorded: Dataset, tmp_path: Path
) -> None:
    record_scripted(boats_at("standard"), tmp_path / "data", count=6, failed=0, seed=4)
    seeds = [
        [run.meta.seed for run in data.successful] for data in (read_dataset(tmp_path / "data"), recorded)
    ]
    assert seeds[0] == seeds[1]


def test_no_failed_run_need_be_asked_for(tmp_path: Path) -> None:
    record_scripted(boats_at("calm"), tmp_path / "data", count=3)
    assert len(read_dataset(tmp_path / "data").successful) == 3


def test_a_folder_that_another_process_is_recording_into_is_refused(tmp_path: Path) -> None:
    with (
        folder_beside(tmp_path / "data"),
        pytest.raises(UserError, match="data: another command is at work on it"),
    ):
        record_scripted(boats_at("calm"), tmp_path / "data", count=1)
    assert list((tmp_path / "data").iterdir()) == []


def test_a_new_dataset_does_not_replace_one_that_was_recorded_meanwhile(tmp_path: Path) -> None:
    record_scripted(boats_at("calm"), tmp_path / "data", count=1, seed=1)
    before = (tmp_path / "data" / "dataset.yaml").read_bytes()
    with pytest.raises(UserError, match="data: already exists"):
        record_scripted(boats_at("calm"), tmp_path / "data", count=1, seed=2, new=True)
    assert (tmp_path / "data" / "dataset.yaml").read_bytes() == before


def test_a_recorded_run_replays_exactly_from_its_seed_state_and_disturbances(recorded: Dataset) -> None:
    assert any(entry["effect"] == "gusts" for entry in recorded.runs[0].meta.disturbances)
    for run in recorded.runs[:3]:
        p = parameters(BOAT)
        apply_effects(
            p, parse_effects(run.meta.disturbances, run.name, BOAT.thruster_names), BOAT.thruster_names
        )
        start = np.array([[run.meta.initial_state[name] for name in ("north", "east", "heading")]])
        speed = np.array([[run.meta.initial_state[name] for name in ("surge", "sway", "yaw_rate")]])
        commands = run.commands(BOAT.thruster_names)[None, :-1]
        gusts = np.array([run.meta.model_dump()["gust_seed"]], dtype=np.uint64)
        track = simulate(
            p, tank(BOAT), initial_state(p, start, speed), commands, gusts, 0.1, substeps_of(0.1, BOAT)
        )[0]
        np.testing.assert_allclose(track[:, :2], run.pose[:, :2], atol=1e-9)
        np.testing.assert_allclose(track[:, 3:6], run.stacked(("surge", "sway", "yaw_rate")), atol=1e-9)
        applied = [
            f"applied_{what}_{name}" for what in ("azimuth", "throttle") for name in BOAT.thruster_names
        ]
        np.testing.assert_allclose(track[:, ACTUATORS:], run.stacked(applied), atol=1e-9)


def test_without_disturbances_the_boat_file_alone_predicts_a_recorded_run(tmp_path: Path) -> None:
    record_scripted(boats_at("calm"), tmp_path / "calm", count=1, failed=0)
    run = read_dataset(tmp_path / "calm").runs[0]
    np.testing.assert_allclose(replay(BOAT, run).pose[:, :2], run.pose[:, :2], atol=1e-9)


def test_commands_are_the_joypad_s_on_the_bow_thrusters(recorded: Dataset) -> None:
    for run in recorded.runs:
        thrust, angle = run.joypad.T
        for name in ("bs", "bp"):
            np.testing.assert_allclose(run.columns[f"azimuth_{name}"], 0.5 * np.pi * angle)
            np.testing.assert_allclose(run.columns[f"throttle_{name}"], thrust)
        for name in ("ss", "sp"):
            assert (run.columns[f"throttle_{name}"] == 0.0).all()


def test_asking_for_more_runs_does_not_change_the_first(recorded: Dataset, tmp_path: Path) -> None:
    record_scripted(boats_at("standard"), tmp_path / "more", count=3, failed=0, seed=4)
    for few, many in zip(read_dataset(tmp_path / "more").runs, recorded.runs, strict=False):
        assert few.meta.seed == many.meta.seed
        np.testing.assert_array_equal(few.pose, many.pose)


def test_a_pilot_that_never_succeeds_ends_in_an_error_and_leaves_no_dataset(tmp_path: Path) -> None:
    asleep = Habits(hesitation_interval=1e-3, hesitation_duration=(1e6, 1e6))
    with pytest.raises(UserError, match=r"0 good .* ended with \d+ timeout; ask"):
        record_scripted(boats_at("calm"), tmp_path / "none", count=1, failed=0, habits=asleep)
    assert list(tmp_path.iterdir()) == []
