"""Settings with which a training cannot succeed are refused in one line that says what to change."""

from collections.abc import Callable, Sequence
from typing import Any

import pytest
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.sb3 import GatesVecEnv

from swamp_rl.errors import SettingsError
from swamp_rl.pilots import dagger
from swamp_rl.pilots.cloning import CloningSettings, fit_cloning
from swamp_rl.pilots.dagger import CloningLearner, DaggerSettings
from swamp_rl.pilots.gru import GRUSettings, fit_gru
from swamp_rl.pilots.ppo import PPOSettings, train_ppo
from swamp_rl.pilots.reservoir import ReservoirSettings, fit_reservoir
from swamp_rl.pilots.reservoir_search import SearchedReservoirSettings, Unsearched, scores
from swamp_rl.pilots.sac import SACSettings, train_sac
from swamp_rl.runs import Run
from tests.support.steering_runs import RUNS, wandering

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore::RuntimeWarning")]

POSE = ("north", "east", "cos_heading", "sin_heading")
CLONE: dict[str, Any] = {"senses": POSE, "epochs": 3, "learning_rate": 1e12}
QUICK: dict[str, Any] = {"boats": 8, "hidden": (8,), "batch_size": 32}
PPO = PPOSettings(**QUICK, decisions=1024, horizon=16, epochs=4, leg=2)
SAC = SACSettings(**QUICK, decisions=400, random=80, leg=20)
SHORT = [wandering(seed, rows=20) for seed in range(4)]
Fit = Callable[[Sequence[Run]], Any]


@pytest.mark.parametrize(
    ("fit", "message"),
    [
        (
            lambda runs: fit_cloning(runs, CloningSettings(**CLONE)),
            "the training diverged; lower learning_rate or weight_decay",
        ),
        (
            lambda runs: fit_gru(runs, GRUSettings(**CLONE, units=4)),
            "the training diverged; lower learning_rate or weight_decay",
        ),
        (
            lambda runs: dagger.fit(runs, DaggerSettings(learner=CloningLearner(**CLONE))),
            "learner: the training diverged; lower learning_rate or weight_decay",
        ),
        (
            lambda runs: fit_reservoir(runs, ReservoirSettings(units=20, forgetting=0.01)),
            "the training diverged; raise forgetting or ridge",
        ),
        (
            lambda runs: fit_reservoir(runs[:1], ReservoirSettings(units=400, ridge=1e-25)),
            "ridge: 1e-25 leaves the regression singular; raise ridge",
        ),
        (
            lambda runs: fit_reservoir(runs, ReservoirSettings(units=20, connectivity=0.0)),
            "connectivity: 0 connects too few of 20 units; raise connectivity",
        ),
    ],
    ids=["cloning", "gru", "dagger", "forgetting", "ridge", "connectivity"],
)
def test_a_fit_without_a_finite_result_names_the_settings_to_change(fit: Fit, message: str) -> None:
    with pytest.raises(SettingsError) as refused:
        fit(RUNS)
    assert str(refused.value) == message


def boats_of(settings: PPOSettings | SACSettings, progress: float = 1.0) -> GatesVecEnv:
    boats = GatesVectorEnv(
        settings.boats,
        observation=settings.senses,
        autoreset_mode="SameStep",
        reward={"progress": progress},
    )
    return GatesVecEnv(boats, settings.hold)


@pytest.mark.parametrize(
    ("train", "settings", "progress"),
    [
        (train_ppo, PPO.model_copy(update={"learning_rate": 100.0}), 1.0),
        (train_ppo, PPO, 1e300),
        (train_sac, SAC.model_copy(update={"learning_rate": 10.0}), 1.0),
    ],
    ids=["ppo", "ppo-reward", "sac"],
)
def test_reinforcement_learning_that_diverges_names_the_settings_to_change(
    train: Callable[..., Any], settings: Any, progress: float
) -> None:
    with pytest.raises(SettingsError) as refused:
        train(boats_of(settings, progress), settings)
    assert str(refused.value) == "the training diverged; lower learning_rate, or the weights of the reward"


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (CloningSettings(reaction=5.0), "run-0: lasts 1.9 s, less than the reaction of 5 s; lower reaction"),
        (ReservoirSettings(reaction=5.0), "run-0: lasts 1.9 s, less than the reaction of 5 s"),
        (
            ReservoirSettings(washout=20),
            "washout: 20 leaves no row to learn from, the longest of 4 runs has 20",
        ),
        (DaggerSettings(learner=CloningLearner(reaction=5.0)), "learner: run-0: lasts 1.9 s"),
        (
            SearchedReservoirSettings(),
            "folds: 5 folds need as many runs, not 4; lower folds, or record more runs",
        ),
        (SearchedReservoirSettings(folds=2, reservoir=Unsearched(washout=20)), "washout: 20 leaves no row"),
    ],
)
def test_settings_that_the_runs_do_not_suffice_for_are_told_before_a_training(
    settings: Any, message: str
) -> None:
    with pytest.raises(SettingsError) as refused:
        settings.check_runs(SHORT)
    assert str(refused.value).startswith(message)
    settings.check_runs([*RUNS, *RUNS])


def test_a_fold_without_a_row_after_the_washout_is_refused() -> None:
    asked = SearchedReservoirSettings(folds=2, units=(10,), reservoir=Unsearched(washout=50))
    with pytest.raises(
        SettingsError, match=r"folds: one has no row to learn from; lower folds or reservoir\."
    ):
        scores([RUNS[0], SHORT[0], RUNS[1], SHORT[1]], asked)
