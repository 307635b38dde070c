"""What an experiment file holds: its keys, their kinds and bounds."""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from swamp_rl.experiments.config.claims import Claims

from swamp_rl.clipped import clipped, printable
from swamp_rl.course import Depth
from swamp_rl.explain import nearest
from swamp_rl.pilots.scripted import Skill

MOST_PILOTS = 100
NAME = r"^[A-Za-z0-9][A-Za-z0-9_.-]*$"
LETTER = r"A-Za-z0-9\u00C0-\uFFFD"
PILOT = f"^[{LETTER}]([{LETTER}_. -]*[{LETTER}_.-])?$"
LONGEST = 100
"""Bytes of a pilot's name, which names a folder of each of its outputs, too."""


def _plain(name: str) -> str:
    if not re.match(NAME, name) or name.endswith("\n"):
        raise ValueError(
            f"{name!r} may have letters, digits, _, . and - of ASCII only, a letter or a digit first"
        )
    return name


def _pilot(name: str) -> str:
    if not re.fullmatch(PILOT, name) or not name.isprintable() or len(name.encode()) > LONGEST:
        raise ValueError(
            f"{clipped(name)!r} may have letters, digits, spaces, _, . and -, a letter or a digit first and "
            f"no space last, {LONGEST} bytes at most"
        )
    return name


def pilot_name(name: str) -> str:
    """The name of a file or a folder as an experiment may call a pilot."""
    plain = "".join(letter if re.match(f"[{LETTER}_. -]", letter) else "_" for letter in printable(name))
    return plain.encode()[:LONGEST].decode(errors="ignore").lstrip("_.- ").rstrip() or "pilot"


Name = Annotated[str, Field(max_length=100, json_schema_extra={"pattern": NAME}), AfterValidator(_plain)]
PilotName = Annotated[
    str, Field(max_length=LONGEST, json_schema_extra={"pattern": PILOT}), AfterValidator(_pilot)
]
Seed = Annotated[int, Field(ge=0, lt=2**31)]
Count = Annotated[int, Field(ge=1, le=100_000)]
"Of runs or episodes, which are held in memory at once."
Rate = Annotated[float, Field(ge=0.0, le=1.0)]
Noise = Annotated[float, Field(ge=0.0)]
Edge = Literal["south", "north", "west", "east"]


def _few(given: Any) -> Any:
    # A greatest length declared as such would be looked at after the items.
    if isinstance(given, Mapping) and len(given) > MOST_PILOTS:
        raise ValueError(f"there are {len(given)}, at most {MOST_PILOTS} are compared")
    return given


def _once(skills: tuple[str, ...]) -> tuple[str, ...]:
    if len(set(skills)) < len(skills):
        raise ValueError("one is named twice; name each once")
    return skills


Skills = Annotated[tuple[Skill, ...], Field(strict=False, min_length=1), AfterValidator(_once)]


class Part(BaseModel):
    """A strict, frozen section of an experiment file."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False, use_attribute_docstrings=True
    )


class Record(Part):
    """Runs of the scripted pilot to be recorded: the first `good` successful and `failed` failed ones.

    Other failed runs are left out. disturbances: the level they are driven at, None for none. skills: of the
    drivers, each of whom drives as many runs, in the same episodes.
    """

    good: Count = 40
    failed: Annotated[int, Field(ge=0, le=100_000)] = 0
    disturbances: str | None = None
    seed: Seed = 0
    skills: Skills = ("usual",)

    def successes(self, skill: Skill | None) -> int:
        """How many successful runs it makes, of the driver of that skill if given."""
        return self.good * (len(self.skills) if skill is None else 1)


def _one_folder(folder: Any) -> Any:
    if isinstance(folder, list):
        raise ValueError("names one dataset; join several: swamp-rl runs import DATASET DATASET … --out NEW")
    return folder


class Data(Part):
    """What the pilots learn from: the dataset in `folder`, or one recorded now into the results.

    sha256: what the folder's files must add up to, written out in the configuration kept with results.
    """

    folder: Annotated[str | None, BeforeValidator(_one_folder, json_schema_input_type=str | None)] = None
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

    runs: how many of the runs with one of `outcomes` it learns from (None is all). skill: only of those that
    the driver of that skill drove, where `data.record.skills` has several. takeover: for so long [s]
    the scripted pilot drives before it. disturbances: the level it trains in. options: of its training, by
    the names that its kind gives them; once loaded, every one of them.
    """

    kind: str
    runs: Count | None = None
    outcomes: Annotated[tuple[str, ...], Field(strict=False, min_length=1)] = ("success",)
    skill: Skill | None = None
    takeover: Annotated[float, Field(ge=0.0, le=3600.0)] = 0.0
    disturbances: str | None = None
    options: dict[str, Any] = {}


def senses_in(options: Any) -> Iterator[Sequence[str]]:
    """Every list of observations in a pilot's options, those of a learner within it included."""
    for key, value in options.items() if isinstance(options, Mapping) else ():
        if key == "senses" and isinstance(value, list | tuple):
            yield value
        else:
            yield from senses_in(value)


def _left(pilots: Any) -> Any:
    """The pilots without those set to null."""
    if not isinstance(pilots, dict):
        return pilots
    return {name: plan for name, plan in pilots.items() if plan is not None}


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


def _without_null(success: Any) -> Any:
    """The targets by pilot and level without those set to null."""
    if not isinstance(success, dict):
        return success
    kept = {pilot: rates for pilot, rates in success.items() if rates is not None}
    return {
        pilot: {level: rate for level, rate in rates.items() if rate is not None}
        if isinstance(rates, dict)
        else rates
        for pilot, rates in kept.items()
    }


class Targets(Part):
    """To be reached: success rates by pilot and level, and the pilots to be smoother than the data.

    A pilot or a level set to null has no target.
    """

    success: Annotated[
        dict[str, dict[str, Rate]],
        BeforeValidator(_without_null, json_schema_input_type=dict[str, dict[str, Rate | None] | None]),
    ] = {}
    smoother_than_data: Annotated[tuple[str, ...], Field(strict=False)] = ()


class Tracking(Part):
    """Where trainings are logged beside the results, which hold TensorBoard's event files anyhow.

    mlflow: a folder, `sqlite:///FILE` or the address of a server.
    """

    mlflow: str | None = None


class Experiment(Part):
    """One experiment, whole. boat, course and levels are names in `configs/` or paths; step in s.

    reward: weights of terms by name, for training and evaluation alike. time_limit [s], bounds [m], some or
    all of the edges, and depth [m]: in place of the course's. These are arguments of the environments too,
    and so are the names that a pilot's `senses` give: docs/environment.md.

    With `hidden` it closes the loop from logs to pilots, see `experiments.studies.closed_loop`; with `claims`
    it tests hypotheses, see `experiments.studies.claims`; with `smoke` it is made too small to say anything,
    see `experiments.config.smoke`.
    """

    extends: Annotated[str | None, Field(exclude=True)] = None
    "Another experiment, by name or by a path from this file, whose keys this one overrides."
    name: Name
    description: str = ""
    boat: str
    course: str
    step: Annotated[float, Field(gt=0.0, le=1.0)] = 0.1
    reward: dict[str, float] = {}
    time_limit: float | None = None
    bounds: dict[Edge, float] = {}
    depth: Depth | None = None
    data: Data = Data()
    pilots: Annotated[
        dict[PilotName, PilotPlan], Field(min_length=1), BeforeValidator(_few), BeforeValidator(_left)
    ]
    "By name; null drops one of the experiment that this one extends, and its targets."
    evaluation: Evaluation
    targets: Targets = Targets()
    hidden: Hidden | None = None
    claims: Claims | None = None
    tracking: Tracking = Tracking()
    smoke: bool = False

    @model_validator(mode="after")
    def _records_the_runs_that_are_asked_for(self) -> Self:
        if self.data.folder is not None:
            return self
        record = self.data.record
        several = record.skills if len(record.skills) > 1 else ()
        for name, plan in self.pilots.items():
            if plan.skill is not None and plan.skill not in several:
                raise ValueError(
                    f"pilots.{name}.skill: data.record.skills must name {plan.skill} and another; add them"
                )
            recorded = record.successes(plan.skill)
            if (plan.runs or 0) > recorded and plan.outcomes == ("success",):
                raise ValueError(
                    f"pilots.{name}.runs: {plan.runs} runs are asked for, data.record makes {recorded} "
                    "good ones; record more, or learn from fewer"
                )
        return self

    @model_validator(mode="after")
    def _targets_name_its_pilots(self) -> Self:
        for name in (*self.targets.success, *self.targets.smoother_than_data):
            if name not in self.pilots:
                raise ValueError(f"targets: no pilot {name!r}{nearest(name, self.pilots)}")
        return self
