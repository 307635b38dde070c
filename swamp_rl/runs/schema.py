"""What `dataset.yaml` says about a dataset and each of its runs."""

from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator, model_validator

from swamp_rl.boat import Boat
from swamp_rl.names import YAML, plain_name
from swamp_rl.runs.table import FORMATS

META, COURSE = "dataset.yaml", ".course.yaml"
ANALYSIS = "analysis"
"The folder of a dataset to which verbs write what they find in its runs."
"""What describes a dataset, and how the name of the copy of its course ends."""
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
LEAST_RATE, MOST_RATE = 1e-9, 1e9
"""Hz: rows that are closer or farther apart have times in another unit."""
Rate = Annotated[float, Field(ge=LEAST_RATE, le=MOST_RATE)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Source = Literal["measured", "simulated", "human", "scripted", "learned"]


class RunMeta(BaseModel):
    """One run beside its table: enough to replay a simulated run exactly. Other keys are kept as they are.

    `file` and `rows` are filled in by the writer. `initial_state`: SI values by column name, where the first
    row does not say it all. `disturbances`: a level's name, or a list of effects. `gates`: the instant [s] of
    the first row past each gate, in order. `outcome`: 'success', or what ended the run. `group`: day or place
    of runs that share their weather. `velocity_axes`: `earth` where surge and sway were made of velocities to
    north and east by the heading of their row, so that they have its error.
    """

    model_config = ConfigDict(extra="allow", frozen=True, strict=True)

    file: str | None = None
    rows: Annotated[int, Field(ge=0)] | None = None
    seed: Annotated[int, Field(ge=0)] | None = None
    initial_state: dict[str, Finite] | None = None
    disturbances: str | list[dict[str, Any]] | None = None
    gates: list[Finite] | None = None
    outcome: str | None = None
    group: str | None = None
    velocity_axes: Literal["boat", "earth"] | None = None


OF_THE_START = ("seed", "initial_state", "gust_seed", "earlier_commands")
"""Entries of a run from which it is replayed from its first row on."""
OF_THE_WHOLE = ("outcome", "gates", "seconds")
"""Entries that tell how all of a run went."""
FOUND_ANEW = ("commands", "unknown_columns")
"""Remarks of an import on the columns that it lacks or does not know, under its boat and mapping."""


def of_part(metadata: Mapping[str, Any], first: bool, last: bool) -> dict[str, Any]:
    """The entries of a run that are true of a part of it; first, last: whether the part has these rows."""
    lost = (() if first else OF_THE_START) + (() if first and last else OF_THE_WHOLE)
    return {key: value for key, value in metadata.items() if key not in lost}


FROM_A_FILE = object()
"""The context of a validation of what anyone may have written."""


class DatasetMeta(BaseModel):
    """`dataset.yaml`: mass [kg], draught [m], water_density [kg/m³], sample_rate [Hz].

    `vehicle`, `course`: names; who makes a dataset may give paths, whose files are then copied into it.
    `copies`: SHA-256 of each of those copies by name, VEHICLE.yaml with what it extends, COURSE.course.yaml.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    vehicle: str
    mass: Positive
    draught: Positive
    water_density: Positive
    sample_rate: Rate
    source: Source
    course: str | None = None
    notes: str | None = None
    licence: str | None = None
    copies: dict[str, Annotated[str, Field(pattern="^[0-9a-f]{64}$")]] = {}
    runs: list[RunMeta] = []

    @field_validator("vehicle", "course")
    @classmethod
    def _are_names_in_a_file(cls, name: str | None, info: ValidationInfo) -> str | None:
        return plain_name(name) if name is not None and info.context is FROM_A_FILE else name

    @field_validator("copies")
    @classmethod
    def _are_named_plainly(cls, copies: dict[str, str]) -> dict[str, str]:
        for name in copies:
            if plain_name(name, YAML) == META:
                raise ValueError(f"{META} is not a copy; remove the entry")
        return copies

    @model_validator(mode="after")
    def _runs_name_their_own_files(self) -> Self:
        names: set[str] = set()
        for number, run in enumerate(self.runs):
            where = f"runs.{number}.file"
            if run.file is None:
                raise ValueError(f"{where} is missing; name the run's .csv or .parquet file")
            path = PurePosixPath(run.file)
            try:
                plain_name(run.file, [f".{kind}" for kind in FORMATS])
            except ValueError as error:
                raise ValueError(
                    f"{where} must be the name of a .csv or .parquet file in the folder; {error}"
                ) from error
            if path.stem in names:
                raise ValueError(f"{where}: a run named {path.stem!r} is listed twice; remove or rename one")
            names.add(path.stem)
        return self


def parsed_meta(data: Mapping[str, Any]) -> DatasetMeta:
    """What a file says of a dataset, wherever it comes from; ValidationError where a name is a path."""
    return DatasetMeta.model_validate(data, context=FROM_A_FILE)


def meta_of(boat: Boat, vehicle: str | Path, rate: float, source: Source, **more: Any) -> DatasetMeta:
    """What a dataset of a boat says: the boat as it is, under its name or file `vehicle`; rate [Hz]."""
    return DatasetMeta(
        vehicle=str(vehicle),
        mass=boat.mass,
        draught=boat.draught,
        water_density=boat.water_density,
        sample_rate=rate,
        source=source,
        **more,
    )


def entries_of(dataset: DatasetMeta, file: str) -> RunMeta:
    """What a dataset says of the run in a file of it, without what each import tells anew."""
    found = next((run.model_dump() for run in dataset.runs if run.file == file), {})
    return RunMeta.model_validate({key: value for key, value in found.items() if key not in FOUND_ANEW})
