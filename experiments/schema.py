"""What an experiment file holds, read strictly, with `extends:` and with overrides from the command line."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, Self

import yaml
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator
from swamp_rl.experiments.claims_schema import Claims
from swamp_rl.experiments.learners import LEARNERS, in_order, learner
from swamp_rl.experiments.smoke import shrunk

from swamp_rl.errors import UserError
from swamp_rl.explain import nearest
from swamp_rl.files import find_config, read_yaml, validated
from swamp_rl.pilots.settings import settings_from

Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$")]
Seed = Annotated[int, Field(ge=0, lt=2**31)]
Count = Annotated[int, Field(ge=1)]
Rate = Annotated[float, Field(ge=0.0, le=1.0)]
Noise = Annotated[float, Field(ge=0.0)]


def _known_kind(kind: str) -> str:
    if kind not in LEARNERS:
        raise ValueError(f"{kind!r} is no kind of pilot{nearest(kind, LEARNERS)}")
    return kind


Kind = Annotated[str, AfterValidator(_known_kind)]


class Part(BaseModel):
    """A strict, frozen section of an experiment file."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False, use_attribute_docstrings=True
    )


class Record(Part):
    """Runs of the scripted pilot to be recorded: `good` ones, and all that fail meanwhile, `failed` or more.

    disturbances: the level they are driven at, None for none.
    """

    good: Count = 40
    failed: Annotated[int, Field(ge=0)] = 0
    disturbances: str | None = None
    seed: Seed = 0


class Data(Part):
    """What the pilots learn from: the dataset in `folder`, or one recorded now into the results.

    sha256: what the folder's files must add up to, written out in the configuration kept with results.
    """

    folder: str | None = None
    sha256: str | None = None
    record: Record = Record()


class Logs(Part):
    """Runs of the scripted pilot in a true boat, as its sensors see them.

    disturbances: the level they are driven at, None for none. Noise: standard deviations [SI, rad].
    """

    runs: Count = 8
    disturbances: str | None = None
    seed: Seed = 0
    position_noise: Noise = 0.05
    heading_noise: Noise = 0.009
    velocity_noise: Noise = 0.03
    yaw_rate_noise: Noise = 0.005


class Hidden(Part):
    """A true boat that differs from its file by effects which must be found from logs."""

    effects: Annotated[list[dict[str, Any]], Field(min_length=1)]
    logs: Logs = Logs()


class PilotPlan(Part):
    """A pilot to be trained and evaluated.

    runs: how many of the runs with one of `outcomes` it learns from (None is all). takeover: for so long [s]
    the scripted pilot drives before it. disturbances: the level it trains in. options: of its training, by
    the names that its kind gives them; once loaded, every one of them.
    """

    kind: Kind
    runs: Count | None = None
    outcomes: Annotated[tuple[str, ...], Field(strict=False, min_length=1)] = ("success",)
    takeover: Annotated[float, Field(ge=0.0)] = 0.0
    disturbances: str | None = None
    options: dict[str, Any] = {}

    @model_validator(mode="after")
    def _asks_for_what_its_kind_has(self) -> Self:
        learns = learner(self.kind)
        if self.runs is not None and not learns.from_runs:
            raise ValueError(f"runs: {self.kind} does not learn from runs; drop the key")
        if self.outcomes != ("success",) and not learns.from_runs:
            raise ValueError(f"outcomes: {self.kind} does not learn from runs; drop the key")
        if self.disturbances is not None and not learns.by_trying:
            raise ValueError(f"disturbances: {self.kind} does not train among them; drop the key")
        if self.takeover > 0.0 and self.kind == "scripted":
            raise ValueError("takeover: it would take over from itself; drop the key")
        return self


class Evaluation(Part):
    """The same `episodes` for every pilot at every level; `shown` of them are drawn in the report."""

    levels: Annotated[tuple[str, ...], Field(strict=False, min_length=1)]
    episodes: Count
    seed: Seed
    shown: Count = 30

    @model_validator(mode="after")
    def _levels_differ(self) -> Self:
        names = [Path(level).stem for level in self.levels]
        if len(set(names)) < len(names):
            raise ValueError("levels: two have the same name; name each once")
        return self


class Targets(Part):
    """To be reached: success rates by pilot and level, and the pilots to be smoother than the data."""

    success: dict[str, dict[str, Rate]] = {}
    smoother_than_data: Annotated[tuple[str, ...], Field(strict=False)] = ()


class Tracking(Part):
    """Where trainings are logged beside the results, which hold TensorBoard's event files anyhow.

    mlflow: a folder, `sqlite:///FILE` or the address of a server.
    """

    mlflow: str | None = None


class Experiment(Part):
    """One experiment, whole. boat, course and levels are names in `configs/` or paths; step in s.

    With `hidden` it closes the loop from logs to pilots, see `experiments.closed_loop`; with `claims` it
    tests hypotheses, see `experiments.claims`; with `smoke` it is made too small to say anything, see
    `experiments.smoke`.
    """

    extends: Annotated[str | None, Field(exclude=True)] = None
    "Another experiment, by name or by a path from this file, whose keys this one overrides."
    name: Name
    description: str = ""
    boat: str
    course: str
    step: Annotated[float, Field(gt=0.0, le=1.0)] = 0.1
    data: Data = Data()
    pilots: Annotated[dict[Name, PilotPlan], Field(min_length=1)]
    evaluation: Evaluation
    targets: Targets = Targets()
    hidden: Hidden | None = None
    claims: Claims | None = None
    tracking: Tracking = Tracking()
    smoke: bool = False

    @model_validator(mode="after")
    def _records_the_runs_that_are_asked_for(self) -> Self:
        recorded = None if self.data.folder is not None else self.data.record.good
        for name, plan in self.pilots.items():
            if recorded is not None and (plan.runs or 0) > recorded and plan.outcomes == ("success",):
                raise ValueError(
                    f"pilots.{name}.runs: {plan.runs} runs are asked for, data.record.good is {recorded}; "
                    "record more, or learn from fewer"
                )
        return self

    @model_validator(mode="after")
    def _targets_name_what_is_there(self) -> Self:
        levels = [Path(level).stem for level in self.evaluation.levels]
        for name in (*self.targets.success, *self.targets.smoother_than_data):
            if name not in self.pilots:
                raise ValueError(f"targets: no pilot {name!r}{nearest(name, self.pilots)}")
        for name in (level for by in self.targets.success.values() for level in by):
            if name not in levels:
                raise ValueError(f"targets: no level {name!r}{nearest(name, levels)}")
        return self


def load_experiment(name_or_path: str | Path, overrides: Iterable[str] = ()) -> Experiment:
    """The experiment of a file, given by path, by its bare name in configs/experiments or by its results.

    An `extends:` in the file names another whose keys it overrides; `overrides` are `key=value` with a dotted
    key and a YAML value, and come last. UserError names the file and the key of the first fault.
    """
    path = _file_of(name_or_path)
    return _read(path, _extended(path, ()), overrides)


def overridden(
    where: str | Path, experiment: Experiment, changes: Mapping[str, Any], overrides: Iterable[str] = ()
) -> Experiment:
    """The experiment with `changes` by key over it, then `overrides`; UserError names `where` and the key."""
    return _read(where, merged(experiment.model_dump(mode="json"), changes), overrides)


def _read(where: str | Path, data: dict[str, Any], overrides: Iterable[str]) -> Experiment:
    for override in overrides:
        data = merged(data, _parsed(override))
    return _with_all_options(where, validated(where, Experiment, data))


def _file_of(name_or_path: str | Path) -> Path:
    """The file meant; a folder of results means the one in its `config`, where there is one."""
    given = Path(name_or_path)
    for file in (given / "config" / "experiment.yaml", given / "experiment.yaml"):
        if file.is_file():
            return file
    try:
        return find_config("experiments", name_or_path)
    except UserError as error:
        if given.is_dir():
            raise UserError(
                f"{given}: no config/experiment.yaml in this folder; name one of results, or an experiment"
            ) from error
        raise


def _with_all_options(path: str | Path, experiment: Experiment) -> Experiment:
    """The experiment with every option of its pilots written out; UserError for an unknown or wrong one."""
    pilots = {}
    for name, plan in experiment.pilots.items():
        settings = settings_from(f"{path}: pilots.{name}.options", learner(plan.kind).settings, plan.options)
        pilots[name] = plan.model_copy(update={"options": settings.model_dump(mode="json")})
    try:
        in_order(pilots)
    except UserError as error:
        raise UserError(f"{path}: {error}") from error
    whole = experiment.model_copy(update={"pilots": pilots})
    return shrunk(whole) if experiment.smoke else whole


def merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """`below` with the keys of `above` over it, mapping into mapping; other values replace those below."""
    result = dict(below)
    for key, value in above.items():
        under = result.get(key)
        if isinstance(under, Mapping) and isinstance(value, Mapping):
            value = merged(under, value)
        result[key] = value
    return result


def _extended(path: Path, seen: tuple[Path, ...]) -> dict[str, Any]:
    if path.resolve() in seen:
        raise UserError(f"{path}: extends itself by way of {seen[-1].name}; end the circle")
    data = read_yaml(path)
    base = data.pop("extends", None)
    if base is None:
        return data
    if not isinstance(base, str):
        raise UserError(f"{path}: extends must name another experiment, not {base!r}")
    beside = path.parent / base
    found = (
        beside
        if beside.suffix in (".yaml", ".yml") and beside.is_file()
        else find_config("experiments", base)
    )
    return merged(_extended(found, (*seen, path.resolve())), data)


def _parsed(override: str) -> dict[str, Any]:
    key, equals, text = override.partition("=")
    if not equals or not all(key.split(".")):
        raise UserError(
            f"--set {override}: must be key=value, with a dotted key such as evaluation.episodes=100"
        )
    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise UserError(f"--set {override}: the value is malformed YAML; put it in quotes") from error
    for part in reversed(key.split(".")):
        value = {part: value}
    return value
