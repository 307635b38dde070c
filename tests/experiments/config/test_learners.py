"""The registry of learners: one entry is enough to choose, describe and train a kind of pilot."""

import subprocess
import sys
from pathlib import Path

import pytest
from swamp_rl.experiments.config import learners
from swamp_rl.experiments.config.learners import LEARNERS, Learner, Training, in_order, learner
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import read_scene
from swamp_rl.experiments.config.schema import PilotPlan

from swamp_rl.errors import UserError
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.settings import Settings
from swamp_rl.runs import Dataset, Run, RunMeta
from tests.support.runs import circling, described

EXPERIMENT = """
name: pupils
boat: swamp
course: camogli
pilots:
  last: {kind: pupil, disturbances: calm, options: {start: second}}
  second: {kind: pupil, options: {start: first}}
  first: {kind: scripted}
evaluation: {levels: [calm], episodes: 1, seed: 1}
"""


class PupilSettings(Settings):
    start: str | None = None


def watch(training: Training) -> Pilot:
    """Drives as the pilot that it starts from."""
    start = training.trained[training.settings.start]
    assert isinstance(start, ScriptedPilot)
    return start


@pytest.fixture
def pupils(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """An experiment with a kind of pilot that nothing but one entry describes."""
    entry = Learner(PupilSettings, watch, lambda plan: "a master", by_trying=True, starts_from=("start",))
    monkeypatch.setitem(learners.LEARNERS, "pupil", lambda: entry)
    (tmp_path / "pupils.yaml").write_text(EXPERIMENT)
    return tmp_path / "pupils.yaml"


def test_a_pilot_comes_after_those_it_starts_from(pupils: Path) -> None:
    plans = load_experiment(pupils).pilots
    assert in_order(plans) == ["first", "second", "last"]
    assert in_order(plans, ["second"]) == ["first", "second"]


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("pilots.second.options.start=frist", "did you mean 'first'"),
        ("pilots.second.options.start=last", "end the circle"),
        ("pilots.second.options.start=second", "end the circle"),
        ("pilots.second.runs=3", "does not learn from runs"),
        ("pilots.second.outcomes=[buoy]", "does not learn from runs"),
        ("pilots.second.options.strat=first", "did you mean 'start'"),
    ],
)
def test_what_a_kind_does_not_have_is_refused_in_one_line(pupils: Path, override: str, message: str) -> None:
    with pytest.raises(UserError, match=message) as complaint:
        load_experiment(pupils, [override])
    assert "\n" not in str(complaint.value)


def test_ppo_that_is_to_start_from_a_pilot_of_another_kind_is_refused_before_any_work() -> None:
    with pytest.raises(UserError, match="cannot start from 'reservoir' of kind reservoir; name a pilot"):
        load_experiment("smoke", ["pilots.ppo.options.start=reservoir"])
    assert load_experiment("smoke", ["pilots.ppo.options.start=cloning"]).pilots["ppo"].options["start"]


@pytest.mark.parametrize("kind", LEARNERS)
def test_every_kind_that_learns_tells_what_it_learned_from(kind: str) -> None:
    least = {"folder": "here"} if kind == "stored" else {}
    options = learner(kind).settings.model_validate(least).model_dump(mode="json")
    assert bool(learner(kind).description(PilotPlan(kind=kind, options=options))) == (
        kind not in ("scripted", "line-of-sight")
    )


def test_a_pilot_learns_from_the_failed_runs_that_its_plan_asks_for() -> None:
    experiment = load_experiment("smoke", ["pilots.cloning.outcomes=[success, buoy]"])
    plan = experiment.pilots["cloning"]
    good, bad = (Run(name, circling(), RunMeta(outcome=name)) for name in ("success", "buoy"))
    dataset = Dataset(Path("runs"), described(), [bad, good])
    chosen = Training(read_scene(experiment), plan, None, dataset, lambda done: None).runs()
    assert [run.name for run in chosen] == ["buoy", "success"]
    assert learner(plan.kind).description(plan) == "all runs that ended in success or buoy"


def test_reading_an_experiment_loads_no_library_for_training() -> None:
    code = (
        "import sys; from swamp_rl.experiments.config.load import load_experiment;"
        "load_experiment('camogli');"
        "print(sorted({'torch', 'stable_baselines3', 'reservoirpy'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
