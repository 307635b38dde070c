"""What `dataset.yaml` says about a dataset and each of its runs."""

from pathlib import PurePosixPath
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Source = Literal["measured", "simulated", "human", "scripted", "learned"]


class RunMeta(BaseModel):
    """One run beside its table: enough to replay a simulated run exactly. Other keys are kept as they are.

    `file` and `rows` are filled in by the writer. `initial_state`: SI values by column name, where the first
    row does not say it all. `disturbances`: a level's name, or a list of effects. `gates`: the instant [s] of
    the first row past each gate, in order. `outcome`: 'success', or what ended the run.
    """

    model_config = ConfigDict(extra="allow", frozen=True, strict=True)

    file: str | None = None
    rows: Annotated[int, Field(ge=0)] | None = None
    seed: Annotated[int, Field(ge=0)] | None = None
    initial_state: dict[str, Finite] | None = None
    disturbances: str | list[dict[str, Any]] | None = None
    gates: list[Finite] | None = None
    outcome: str | None = None


class DatasetMeta(BaseModel):
    """`dataset.yaml`: mass [kg], draught [m], water_density [kg/m³], sample_rate [Hz]."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    vehicle: str
    mass: Positive
    draught: Positive
    water_density: Positive
    sample_rate: Positive
    source: Source
    course: str | None = None
    notes: str | None = None
    licence: str | None = None
    runs: list[RunMeta] = []

    @model_validator(mode="after")
    def _runs_name_their_own_files(self) -> Self:
        names: set[str] = set()
        for number, run in enumerate(self.runs):
            where = f"runs.{number}.file"
            if run.file is None:
                raise ValueError(f"{where} is missing; name the run's .csv or .parquet file")
            path = PurePosixPath(run.file)
            if path.name != run.file or "\\" in run.file or path.suffix.lower() not in (".csv", ".parquet"):
                raise ValueError(
                    f"{where} {run.file!r} must be the name of a .csv or .parquet file in the folder"
                )
            if path.stem in names:
                raise ValueError(f"{where}: a run named {path.stem!r} is listed twice; remove or rename one")
            names.add(path.stem)
        return self
