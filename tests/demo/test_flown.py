"""A pilot beside a run sails the run's own episode, to the bit as its seed and level give it."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.experiments.artifacts.demo_runs import read_shown
from swamp_rl.experiments.artifacts.flown import flown, opened_for

from swamp_rl.boat import load_boat
from swamp_rl.course import load_course
from swamp_rl.demo.conditions import conditions
from swamp_rl.errors import UserError
from swamp_rl.evaluation import drive
from swamp_rl.pilots.arguments import asked_pilot
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.pilots.made_for import made_for
from swamp_rl.pilots.record import record_scripted
from swamp_rl.pilots.store import save_pilot
from swamp_rl.runs import Run, RunMeta, append_run, create_dataset, read_dataset
from swamp_rl.runs.schema import meta_of
from tests.support.demo import dataset
from tests.support.runs import circling

BOAT, COURSE, STEP = load_boat("swamp"), load_course("camogli"), 0.1
MADE = made_for(BOAT, "camogli", STEP)


def boats(level: str):
    return lambda n, senses: GatesVectorEnv(
        n, boat=BOAT, course=COURSE, disturbances=level, observation=senses, step=STEP
    )


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "severe"
    record_scripted(boats("severe"), folder, count=2, seed=3)
    return folder


def test_it_meets_the_weather_that_the_runs_seed_and_level_give(runs: Path) -> None:
    for run in read_dataset(runs).runs:
        assert run.meta.seed is not None and (run.meta.model_extra or {})["level"] == "severe"
        own = flown(LineOfSightPilot(), "line-of-sight", run, BOAT, COURSE, STEP)
        drawn = drive(LineOfSightPilot(), boats("severe"), np.array([run.meta.seed])).run(0, "drawn", STEP)
        for name, values in drawn.columns.items():
            assert np.array_equal(own.columns[name], values), name
        assert own.meta.outcome == drawn.meta.outcome
        assert conditions([run, own]).sentence == f"same start, same weather: severe, seed {run.meta.seed}"


def test_beside_several_runs_it_sails_each_of_their_episodes(runs: Path) -> None:
    scene = read_shown([runs, "line-of-sight"], [], None)
    shown = [(item.group, item.name) for item in scene.shown]
    assert shown == [(who, name) for who in ("scripted", "line-of-sight") for name in ("run-001", "run-002")]
    assert scene.conditions.sentence == "different weather"


def test_beside_a_run_that_tells_nothing_it_starts_there_in_calm_and_that_is_said() -> None:
    measured = Run("tow", circling())
    own = flown(LineOfSightPilot(), "line-of-sight", measured, BOAT, COURSE, STEP)
    assert own.pose[0] == pytest.approx(measured.pose[0])
    assert conditions([measured, own]).sentence == "different weather: tow does not record its own"


@pytest.mark.parametrize(
    ("changes", "part"),
    [
        ({"boat": "launch", "length": 5.0}, "was made for boat launch .5 m, .* cannot drive swamp .1.24 m"),
        ({"boat": "tug", "thrusters": {"pod": "azimuth"}}, "was made for boat tug .*azimuth pod"),
        ({"step": 0.2}, "decides every 0.2 s"),
    ],
)
def test_a_pilot_of_other_thrusters_another_size_or_step_is_refused(
    tmp_path: Path, changes: dict[str, object], part: str
) -> None:
    save_pilot(LineOfSightPilot(), tmp_path / "p", made=MADE.model_copy(update=changes))
    with pytest.raises(UserError, match=part):
        opened_for(asked_pilot(str(tmp_path / "p")), BOAT, STEP)
    save_pilot(LineOfSightPilot(), tmp_path / "p", made=MADE)
    opened_for(asked_pilot(str(tmp_path / "p")), BOAT, STEP)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({}, ""),
        ({"boat": "swamp-light", "boat_sha256": "0" * 64}, "was made for boat swamp-light, it drives swamp"),
        ({"boat_sha256": "0" * 64, "length": None}, "was made for another version of boat swamp"),
    ],
)
def test_a_pilot_of_another_boat_with_the_same_thrusters_drives_with_a_note(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], changes: dict[str, object], text: str
) -> None:
    save_pilot(LineOfSightPilot(), tmp_path / "p", made=MADE.model_copy(update=changes))
    opened_for(asked_pilot(str(tmp_path / "p")), BOAT, STEP)
    message = capsys.readouterr().err
    assert text in message and len(message.splitlines()) == bool(text)


def test_a_pilot_that_observes_what_there_is_not_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    methods = "train = save = load = reset = act = print"
    (tmp_path / "dreamer.py").write_text(f"class Pilot:\n    senses = 'north', 'nort'\n    {methods}\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(
        UserError, match=r"^dreamer:Pilot: observation: unknown name 'nort'; did you mean 'north'"
    ):
        opened_for(asked_pilot("dreamer:Pilot"), BOAT, STEP)


def test_a_pilot_alone_drives_its_boat_in_a_run_of_the_experiment_that_it_was_trained_in(
    tmp_path: Path,
) -> None:
    file, home = tmp_path / "launch.yaml", tmp_path / "results"
    file.write_text("extends: swamp\nname: launch\nlength: 2.0\n")
    launch = load_boat(file)
    create_dataset(home / "data", meta_of(launch, str(file), 10.0, "scripted", course="camogli"), file)
    for name, outcome in (("run-001", "buoy"), ("run-002", "success"), ("run-003", "success")):
        append_run(home / "data", Run(name, circling(), RunMeta.model_validate({"outcome": outcome})))
    (home / "config").mkdir()
    (home / "config" / "experiment.yaml").touch()
    save_pilot(LineOfSightPilot(), home / "pilots" / "mine", made=made_for(launch, "camogli", STEP))
    scene = read_shown(["line-of-sight", home / "pilots" / "mine"], [], None)
    shown = [(item.group, item.name) for item in scene.shown]
    assert shown == [(who, "run-002") for who in ("scripted", "line-of-sight", "mine")]
    assert (scene.title, scene.length) == ("results", 2.0)


def test_beside_runs_without_a_course_no_pilot_is_flown(tmp_path: Path) -> None:
    folder = dataset(tmp_path / "pond", "human", ["x"], course=None)
    with pytest.raises(UserError, match="no course"):
        read_shown([folder, "line-of-sight"], [], None)
