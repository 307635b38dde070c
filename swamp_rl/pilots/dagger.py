"""DAgger (Ross, Gordon and Bagnell 2011): the learner drives, an expert labels the states it visits.

Logged runs do not cover the states that a learner's errors lead to. Each round adds runs that the learner
drives and the expert labels, and the learner is fitted again to all.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, field_validator

from swamp_rl.boat import Boat
from swamp_rl.errors import errors_at
from swamp_rl.one_thread import one_thread
from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.callbacks import Log, Tick
from swamp_rl.pilots.cloning import CloningSettings, fit_cloning
from swamp_rl.pilots.dagger_checkpoint import Rounds, load_rounds, save_rounds
from swamp_rl.pilots.demonstrations import LAST, last_action
from swamp_rl.pilots.gru import GRUPilot, GRUSettings, fit_gru
from swamp_rl.pilots.network import NetworkPilot
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.pilots.record import MakeBoats, drive_episodes
from swamp_rl.pilots.regression import task_of
from swamp_rl.pilots.reservoir import ReservoirPilot, ReservoirSettings, fit_reservoir
from swamp_rl.pilots.scripted import Habits, ScriptedPilot
from swamp_rl.pilots.settings import Many, Seed, Settings
from swamp_rl.runs import Run

STEADY = Habits(messy=0.0, gentle=0.0, guess_interval=1e6, hesitation_interval=1e6)
"The scripted pilot's reactions, aims and dead bands without slips."
OwnSeed = Annotated[int, Field(ge=0, lt=2**32, exclude=True)]


class ReservoirLearner(ReservoirSettings):
    """A reservoir in DAgger's rounds."""

    kind: Literal["reservoir"] = "reservoir"
    seed: OwnSeed = 0


class CloningLearner(CloningSettings):
    """A cloned network in DAgger's rounds."""

    kind: Literal["cloning"] = "cloning"
    seed: OwnSeed = 0


class GRULearner(GRUSettings):
    """A gated recurrent unit in DAgger's rounds."""

    kind: Literal["gru"] = "gru"
    seed: OwnSeed = 0


Learner = ReservoirLearner | CloningLearner | GRULearner


class DaggerSettings(Settings):
    """Settings of DAgger: learner, rounds and expert."""

    learner: Annotated[Learner, Field(discriminator="kind")] = ReservoirLearner()
    rounds: Many = 5
    runs: Annotated[int, Field(ge=1, le=1_000)] = 2
    "Runs that the learner drives and the expert labels in each round."
    expert: Habits = STEADY
    "Habits of the scripted pilots that label, one for each run; their `boat_length` is the boat's."
    trials: Annotated[int, Field(ge=0, le=100_000)] = 200
    """Validation episodes of each round: the learner with most successes is returned (the later of equals);
    with 0 episodes the last one."""
    seed: Seed = 0
    "Seed of the rounds and of the learner."

    @field_validator("learner")
    @classmethod
    def _one_seed(cls, learner: Learner) -> Learner:
        if learner.seed != 0:
            raise ValueError("seed: is that of the rounds; give it beside learner, not in it")
        return learner

    @field_validator("expert")
    @classmethod
    def _no_length(cls, expert: Habits) -> Habits:
        if expert.boat_length != STEADY.boat_length:
            raise ValueError("boat_length: is that of the boat; leave it out")
        return expert

    def check_runs(self, runs: Sequence[Run]) -> None:
        """Raise SettingsError as the learner's."""
        with errors_at("learner"):
            self.learner.check_runs(runs)


@one_thread(torch=True)
def fit_dagger(
    first: Sequence[Run],
    make_boats: MakeBoats,
    vehicle: Boat,
    look: Callable[[Run], Run],
    settings: DaggerSettings | None = None,
    step: float = 0.1,
    tick: Tick = lambda done: None,
    log: Log = lambda number, values: None,
    checkpoint: Path | None = None,
) -> Pilot:
    """Return a pilot fitted to the logged runs `first` and to the labelled runs of each round.

    make_boats: builds boats of `vehicle` that reset a step after their end, disturbed as in the rounds; look:
    adds to a run the columns that are observed and not logged (`envs.hindsight.with_gates`). `tick` is called
    with the share done; `log` after each round (0: before the first) with the number of runs fitted to and,
    with validation episodes, the share of successes, including rounds before a resumption. checkpoint: a file
    written after each round and resumed from if it has the same settings and first runs; the learner's own
    checkpoint is beside it. UserError where a run lacks a column or the checkpoint is damaged.
    """
    settings = settings or DaggerSettings()
    task = task_of(settings, (column for run in first for column in run.columns.values()))
    rounds = Rounds() if checkpoint is None else load_rounds(checkpoint, task)
    within = None if checkpoint is None else checkpoint.with_name(f"{checkpoint.name}-round")
    habits = settings.expert.model_copy(update={"boat_length": vehicle.length})
    rng = np.random.default_rng(settings.seed)
    # All seeds are larger than any of an evaluation, so that no pilot is evaluated on its training data.
    trials = rng.integers(2**31, 2**32, settings.trials)
    drawn = [(rng.integers(2**32), rng.integers(2**31, 2**32, settings.runs)) for _ in range(settings.rounds)]
    for number in range(settings.rounds + 1):
        if number >= len(rounds.successes):
            if rounds.learner is not None:
                expert_seed, seeds = drawn[number - 1]
                expert = ScriptedPilot(int(expert_seed), habits, step)
                driven = corrected_runs(rounds.learner, expert, make_boats, vehicle, seeds, step)
                rounds.corrected += [_plain(look(run)) for run in driven]
            _learn(rounds, [*first, *rounds.corrected], settings, make_boats, trials, within)
            if checkpoint is not None:
                save_rounds(checkpoint, rounds, task)
        success = {"success": rounds.successes[number] / len(trials)} if len(trials) else {}
        log(number, {"runs": len(first) + number * settings.runs, **success})
        if number:
            tick(number / settings.rounds)
    if within is not None:
        within.unlink(missing_ok=True)
    assert rounds.best is not None
    return rounds.best


def _learn(
    rounds: Rounds,
    runs: Sequence[Run],
    settings: DaggerSettings,
    make_boats: MakeBoats,
    trials: Array,
    within: Path | None,
) -> None:
    """Fit one round's learner to all `runs` and evaluate it in the episodes `trials` (n,)."""
    rounds.learner = fit(runs, settings, within)
    success = succeeded(rounds.learner, make_boats, trials)
    if rounds.best is None or success >= max(rounds.successes):
        rounds.best = rounds.learner
    rounds.successes.append(success)


def _plain(run: Run) -> Run:
    """Return the run with contiguous columns, as read from a file: strided sums may differ in a last bit."""
    return Run(run.name, {name: np.ascontiguousarray(c) for name, c in run.columns.items()}, run.meta)


def succeeded(pilot: Pilot, make_boats: MakeBoats, seeds: Array) -> int:
    """Return the number of the episodes of `seeds` (n,) in which the pilot succeeds."""
    if len(seeds) == 0:
        return 0
    boats = make_boats(len(seeds), pilot.senses)
    pilot.reset(len(seeds))
    try:
        observation, _ = boats.reset(options={"episodes": seeds})
        running, good = np.ones(len(seeds), dtype=bool), 0
        while running.any():
            observation, _, terminated, truncated, info = boats.step(pilot.act(observation))
            ended = running & (terminated | truncated)
            good += int((info["outcome"][ended] == "success").sum()) if ended.any() else 0
            running &= ~ended
    finally:
        boats.close()
    return good


def fit(
    runs: Sequence[Run], settings: DaggerSettings, checkpoint: Path | None = None
) -> ReservoirPilot | NetworkPilot | GRUPilot:
    """Return the learner fitted to these runs, with the same bits as when read from a file.

    checkpoint: of the learner, where its kind has one.
    """
    learner = settings.learner.model_copy(update={"seed": settings.seed})
    pilot: ReservoirPilot | NetworkPilot | GRUPilot
    with errors_at("learner"):
        if isinstance(learner, ReservoirLearner):
            pilot = fit_reservoir(runs, learner)
        elif isinstance(learner, GRULearner):
            pilot = fit_gru(runs, learner, checkpoint=checkpoint)
        else:
            pilot = fit_cloning(runs, learner, checkpoint=checkpoint)
    weights = {name: np.ascontiguousarray(value) for name, value in pilot.weights().items()}
    return pilot.build(pilot.settings(), weights)


class Watched:
    """A pilot that drives while an expert labels the same observations."""

    def __init__(self, driver: Pilot, expert: Pilot) -> None:
        self.driver, self.expert = driver, expert
        self.senses = tuple(dict.fromkeys((*driver.senses, *expert.senses)))
        self._of_driver, self._of_expert = (
            [self.senses.index(name) for name in pilot.senses] for pilot in (driver, expert)
        )
        self.labels: list[Array] = []
        "Levers (n, 2) of the expert at each step."

    def reset(self, n: int) -> None:
        """Set the number of boats to n."""
        self.driver.reset(n)
        self.expert.reset(n)
        self.labels = []

    def act(self, observation: Array) -> Array:
        """Return the driver's levers (n, 2) for observations (n, d)."""
        self.labels.append(self.expert.act(observation[:, self._of_expert]))
        return self.driver.act(observation[:, self._of_driver])


def corrected_runs(
    driver: Pilot, expert: Pilot, make_boats: MakeBoats, vehicle: Boat, seeds: Array, step: float
) -> list[Run]:
    """Return an episode of `driver` for each of `seeds` (n,), with the levers of `expert` in `joy_thrust` and
    `joy_angle`; the runs cannot be replayed from these."""
    watched = Watched(driver, expert)
    boats = make_boats(len(seeds), watched.senses)
    watched.reset(len(seeds))
    try:
        driven = drive_episodes(boats, watched, vehicle, seeds, step)
    finally:
        boats.close()
    labels = np.array(watched.labels)
    runs = []
    for i, run in enumerate(driven):
        # The last row, where nothing more was decided, keeps the levers before it.
        thrust, angle = labels[np.minimum(np.arange(len(run.time)), len(run.time) - 2), i].T
        driven_by = {name: last_action(run, name) for name in LAST}  # by the driver, who is not the expert
        levers = {"joy_thrust": thrust, "joy_angle": angle}
        runs.append(Run(run.name, {**run.columns, **driven_by, **levers}, run.meta))
    return runs
