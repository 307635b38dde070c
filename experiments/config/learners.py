"""Every kind of pilot an experiment may ask for: its settings, what it learns from and how it is trained.

A new kind is one more entry of LEARNERS, and its class in `swamp_rl.pilots.store.KINDS` to be loaded by. An
entry is a function, so that what one kind needs is imported only where an experiment asks for that kind.
`module:Class` is a researcher's own, see `swamp_rl.pilots.own`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field
from swamp_rl.experiments.config.scene import Scene
from swamp_rl.experiments.config.schema import PilotPlan, Record, senses_in

from swamp_rl.counted import counted
from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.pilots.callbacks import Log, Tick
from swamp_rl.pilots.scripted import Skill
from swamp_rl.pilots.settings import Settings

if TYPE_CHECKING:
    from swamp_rl.envs.batched import GatesVectorEnv

    from swamp_rl.pilots.description import FittedOn
    from swamp_rl.pilots.pilot import Pilot
    from swamp_rl.runs import Dataset, Run


@dataclass(frozen=True)
class Training:
    """What a pilot is trained with."""

    scene: Scene
    plan: PilotPlan
    settings: Any
    "`plan.options`, as the settings of its kind."
    dataset: "Dataset"
    tick: Tick
    "Called with the share done, from 0 to 1."
    checkpoint: Path | None = None
    """The file that the learner may write, whole or not at all (`write_beside`), to go on from, and read
    where an interrupted training with the same settings has left one. Removed once the pilot is saved."""
    log: Log = lambda step, values: None
    "Called with points of the learning curve: decisions, epochs or rounds done, and what was measured then."
    trained: Mapping[str, "Pilot"] = field(default_factory=dict)
    "The pilots that it starts from, by name, without those that drive before a takeover."

    def runs(self) -> "list[Run]":
        """The runs it learns from, with the gates it was heading for; UserError where there are too few."""
        from swamp_rl.envs.hindsight import with_gates

        return [with_gates(run, self.scene.course) for run in self._chosen()]

    def fitted_on(self) -> "FittedOn":
        """Which runs these are, to be stored with the pilot."""
        from swamp_rl.experiments.config.digests import digest, hashes

        from swamp_rl.pilots.description import FittedOn

        return FittedOn(
            dataset=digest(hashes(self.dataset.folder)),
            source=self.dataset.meta.source,
            runs=tuple(run.name for run in self._chosen()),
        )

    def _chosen(self) -> "list[Run]":
        from swamp_rl.pilots.demonstrations import choose_runs

        return choose_runs(self.dataset.runs, self.plan.runs, self.plan.outcomes, self.plan.skill)

    def boats(self, n: int, senses: tuple[str, ...]) -> "GatesVectorEnv":
        """Boats to try in, among the disturbances it trains in; a boat that has ended starts anew at once."""
        return self.scene.boats_at(self.plan.disturbances, at_once=True)(n, senses)


@dataclass(frozen=True)
class Learner:
    """A kind of pilot."""

    settings: type[Settings]
    train: Callable[[Training], "Pilot"]
    description: Callable[[PilotPlan], str]
    "Description of what it learned from; empty where it learned from nothing."
    from_runs: bool = False
    "It learns from runs, so that `runs` and `outcomes` have a meaning."
    by_trying: bool = False
    "It learns in the simulator, so that `disturbances` has a meaning."
    starts_from: tuple[str, ...] = ()
    "Options that name other pilots of the experiment, which are trained first; None names nobody."
    starts_with: tuple[str, ...] = ()
    "The kinds of these pilots; empty for any."
    fitted_on: "Callable[[Training], FittedOn | None] | None" = None
    "The runs that are stored with the pilot as those it learned from; by default those of its training."


def learner(kind: str) -> Learner:
    """The learner of a kind: one of LEARNERS, or a class of one's own, which is imported.

    UserError where there is none.
    """
    if kind in LEARNERS:
        return LEARNERS[kind]()
    from swamp_rl.own_code import is_code
    from swamp_rl.pilots.own import own_kinds

    if not is_code(kind) and kind not in own_kinds():
        known = [*LEARNERS, *own_kinds()]
        raise UserError(f"{kind!r} is not a kind of pilot{nearest(kind, known)}, or module:Class of your own")
    return _own(kind)


def check_logged(where: str, plan: PilotPlan, columns: Sequence[str] = ()) -> None:
    """UserError where a built-in learner from runs is to sense what no environment shows, or what runs with
    these columns do not tell."""
    if plan.kind not in LEARNERS or not learner(plan.kind).from_runs:
        return
    from swamp_rl.envs.observation import observed

    from swamp_rl.pilots.demonstrations import refuse_unlogged

    for senses in senses_in(plan.options):
        try:
            observed(senses)
            refuse_unlogged(senses, columns)
        except UserError as error:
            raise UserError(f"{where}.senses: {error}") from error


def check_recorded(plan: PilotPlan, record: Record) -> None:
    """SettingsError where fewer runs are recorded than a pilot's settings need."""
    if plan.runs is not None or plan.outcomes == ("success",):
        check_count(plan, plan.runs or record.successes(plan.skill))


def check_count(plan: PilotPlan, count: int) -> None:
    """SettingsError where a pilot's settings need more than `count` runs."""
    settings = settings_of_plan(plan)
    if isinstance(settings, Settings):  # a class of one's own may have other ones
        settings.check_count(count)


def check_runs(plan: PilotPlan, runs: "Sequence[Run]") -> None:
    """SettingsError where the runs that a pilot learns from do not suffice for its settings."""
    settings = settings_of_plan(plan)
    if isinstance(settings, Settings):
        settings.check_runs(runs)


def settings_of_plan(plan: PilotPlan) -> Any:
    """The options of a plan as the settings of its kind."""
    return learner(plan.kind).settings.model_validate(plan.options)


def needed(plan: PilotPlan) -> list[str]:
    """The other pilots that a plan, its options written out, starts from."""
    named = [plan.options.get(option) for option in learner(plan.kind).starts_from]
    return [name for name in named if name is not None]


def in_order(plans: Mapping[str, PilotPlan], wanted: list[str] | None = None) -> list[str]:
    """Names of the pilots (of `wanted` and all that these start from), each after those it starts from.

    UserError where one starts from a pilot that is not there, or by some way from itself.
    """
    order: list[str] = []

    def add(name: str, above: tuple[str, ...]) -> None:
        if name in above:
            raise UserError(f"pilots.{name}: starts from itself by way of {above[-1]}; end the circle")
        for other in needed(plans[name]):
            if other not in plans:
                raise UserError(f"pilots.{name}.options: no pilot {other!r}{nearest(other, plans)}")
            kinds = learner(plans[name].kind).starts_with
            if kinds and plans[other].kind not in kinds:
                raise UserError(
                    f"pilots.{name}.options: {plans[name].kind} cannot start from {other!r} of kind "
                    f"{plans[other].kind}; name a pilot of kind {', '.join(kinds)}"
                )
            add(other, (*above, name))
        if name not in order:
            order.append(name)

    for name in plans if wanted is None else wanted:
        add(name, ())
    return order


class ScriptedSettings(Settings):
    """Of the scripted pilot. seed: another one, other habits and slips; skill: what these are drawn from."""

    seed: Annotated[int, Field(ge=0, lt=2**31)] = 0
    skill: Skill = "usual"


def _of_runs(plan: PilotPlan) -> str:
    noun = "successful run" if plan.outcomes == ("success",) else "run"
    runs = f"all {noun}s" if plan.runs is None else f"the first {counted(plan.runs, noun)}"
    driver = "" if plan.skill is None else f" of the {plan.skill} driver"
    if plan.outcomes == ("success",):
        return f"{runs}{driver}"
    return f"{runs}{driver} that ended in {' or '.join(plan.outcomes)}"


def _of_decisions(plan: PilotPlan) -> str:
    tried = f"{plan.options['decisions']:,} decisions in the simulator"
    return f"{tried} at level `{plan.disturbances}`" if plan.disturbances else tried


def _scripted() -> Learner:
    from swamp_rl.pilots.scripted import ScriptedPilot, habits_of

    def train(training: Training) -> "Pilot":
        return ScriptedPilot(
            training.settings.seed,
            habits_of(training.settings.skill, training.scene.boat.length),
            training.scene.experiment.step,
        )

    return Learner(ScriptedSettings, train, description=lambda plan: "")


def _line_of_sight() -> Learner:
    from swamp_rl.pilots.line_of_sight import LineOfSightPilot, LineOfSightSettings

    def train(training: Training) -> "Pilot":
        from swamp_rl.envs.line_of_sight_damping import with_damping

        scene = training.scene
        return LineOfSightPilot(with_damping(training.settings, scene.boat, scene.experiment.step))

    return Learner(LineOfSightSettings, train, description=lambda plan: "")


def _reservoir() -> Learner:
    from swamp_rl.pilots.reservoir import ReservoirSettings, fit_reservoir

    def train(training: Training) -> "Pilot":
        return fit_reservoir(training.runs(), training.settings)

    return Learner(ReservoirSettings, train, _of_runs, from_runs=True)


def _searched_reservoir() -> Learner:
    from swamp_rl.pilots.reservoir_search import SearchedReservoirSettings, fit_searched_reservoir

    def train(training: Training) -> "Pilot":
        return fit_searched_reservoir(training.runs(), training.settings, training.tick)

    return Learner(SearchedReservoirSettings, train, _of_runs, from_runs=True)


def _cloning() -> Learner:
    from swamp_rl.pilots.cloning import CloningSettings, fit_cloning

    def train(training: Training) -> "Pilot":
        return fit_cloning(
            training.runs(), training.settings, training.tick, training.checkpoint, training.log
        )

    return Learner(CloningSettings, train, _of_runs, from_runs=True)


def _gru() -> Learner:
    from swamp_rl.pilots.gru import GRUSettings, fit_gru

    def train(training: Training) -> "Pilot":
        return fit_gru(training.runs(), training.settings, training.tick, training.checkpoint, training.log)

    return Learner(GRUSettings, train, _of_runs, from_runs=True)


def _dagger() -> Learner:
    from swamp_rl.pilots.dagger import DaggerSettings, fit_dagger

    def train(training: Training) -> "Pilot":
        from swamp_rl.envs.hindsight import with_gates

        scene = training.scene
        return fit_dagger(
            training.runs(),
            scene.boats_at(training.plan.disturbances),
            scene.boat,
            lambda run: with_gates(run, scene.course),
            training.settings,
            scene.experiment.step,
            training.tick,
            training.log,
            training.checkpoint,
        )

    def description(plan: PilotPlan) -> str:
        corrected = plan.options["rounds"] * plan.options["runs"]
        level = f", at level `{plan.disturbances}`" if plan.disturbances else ""
        return f"{_of_runs(plan)}, and {corrected} runs of its own with the expert's commands{level}"

    return Learner(DaggerSettings, train, description, from_runs=True, by_trying=True)


def _ppo() -> Learner:
    from swamp_rl.pilots.ppo import PPOSettings, train_ppo

    def train(training: Training) -> "Pilot":
        from swamp_rl.envs.sb3 import GatesVecEnv

        settings = training.settings
        boats = GatesVecEnv(training.boats(settings.boats, settings.senses), settings.hold)
        start = training.trained[settings.start] if settings.start is not None else None
        return train_ppo(boats, settings, training.tick, training.log, training.checkpoint, start)

    networks = ("cloning", "ppo", "sac", "stored")
    return Learner(
        PPOSettings, train, _of_decisions, by_trying=True, starts_from=("start",), starts_with=networks
    )


def _sac() -> Learner:
    from swamp_rl.pilots.sac import SACSettings, train_sac

    def train(training: Training) -> "Pilot":
        from swamp_rl.envs.sb3 import GatesVecEnv

        settings = training.settings
        boats = GatesVecEnv(training.boats(settings.boats, settings.senses), settings.hold)
        return train_sac(boats, settings, training.tick, training.log, training.checkpoint)

    return Learner(SACSettings, train, _of_decisions, by_trying=True)


class StoredSettings(Settings):
    """Of a pilot that was trained before. sha256: of its `pilot.json`; once run, that of what was there."""

    folder: str
    sha256: str | None = None


def _stored() -> Learner:
    from swamp_rl.pilots.store import describe_pilot, load_pilot

    return Learner(
        StoredSettings,
        train=lambda training: load_pilot(training.settings.folder),
        description=lambda plan: f"stored in `{plan.options['folder']}`",
        fitted_on=lambda training: describe_pilot(training.settings.folder).fitted_on,
    )


def _own(kind: str) -> Learner:
    from swamp_rl.pilots.own import OwnPilot, own_class, settings_of

    found = own_class(kind)

    def train(training: Training) -> "Pilot":
        return OwnPilot(kind, found.train(training), training.settings)

    from_runs = getattr(found, "from_runs", True)
    description = _of_runs if from_runs else lambda plan: f"trained by `{plan.kind}`"
    return Learner(settings_of(found), train, description, from_runs=from_runs, by_trying=True)


LEARNERS: dict[str, Callable[[], Learner]] = {
    "scripted": _scripted,
    "line-of-sight": _line_of_sight,
    "reservoir": _reservoir,
    "reservoir-searched": _searched_reservoir,
    "cloning": _cloning,
    "gru": _gru,
    "dagger": _dagger,
    "ppo": _ppo,
    "sac": _sac,
    "stored": _stored,
}
