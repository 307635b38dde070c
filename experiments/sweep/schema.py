"""What a sweep file holds, read strictly."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import yaml
from pydantic import Field, model_validator
from swamp_rl.experiments.config.schema import Count, Name, Part, PilotName, Rate, Seed

from swamp_rl.explain import in_yaml
from swamp_rl.files import config_beside, find_config, read_yaml, validated

MOST_TRIALS = 100_000
LEAST_SUCCESS = 0.9
Listed = Annotated[list[Any], Field(min_length=1)]
Number = Annotated[float, Field(strict=False)]
Ends = Annotated[tuple[Number, Number], Field(strict=False)]
Whole = Annotated[tuple[int, int], Field(strict=False)]
DRAWN = ("choice", "uniform", "log_uniform", "integers")


class Parameter(Part):
    """The values of one key of the experiment: exactly one of these.

    grid: each of them, with each of every other parameter. choice, uniform, log_uniform (two ends), integers
    (two ends, both within): from where a search draws.
    """

    grid: Listed | None = None
    choice: Listed | None = None
    uniform: Ends | None = None
    log_uniform: Ends | None = None
    integers: Whole | None = None

    @model_validator(mode="after")
    def _is_one_of_them(self) -> Self:
        if len(self.model_fields_set) != 1 or getattr(self, self.kind) is None:
            raise ValueError(f"must be exactly one of grid, {', '.join(DRAWN)}")
        if self.kind in ("uniform", "log_uniform", "integers"):
            low, high = getattr(self, self.kind)
            if not low < high:
                raise ValueError(f"{self.kind}: the upper end {high} must be more than the lower, {low}")
            if self.kind == "log_uniform" and low <= 0.0:
                raise ValueError(f"log_uniform: {low} must be more than 0")
        for i, value in enumerate(self.grid or ()):
            if value in (self.grid or ())[:i]:
                raise ValueError(f"grid: {in_yaml(value)} is there twice; name each value once")
        return self

    @property
    def kind(self) -> str:
        """Which of them it is."""
        return next(iter(self.model_fields_set), "grid")

    @property
    def examples(self) -> list[Any]:
        """Every value that it lists, or the ends of its range."""
        return list(getattr(self, self.kind))


class Objective(Part):
    """What is measured of one pilot at one level: its success, or a mean cost of its successful episodes.

    least_success: for a cost, the success rate from which trials are compared by it, by default 0.9; trials
    of a lower rate come after all others, in the order of their success.
    """

    pilot: PilotName
    level: str
    measure: Literal["success", "time", "path_length", "command_change", "energy"] = "success"
    direction: Literal["maximize", "minimize"] | None = None
    least_success: Rate | None = None

    @model_validator(mode="after")
    def _is_of_a_cost(self) -> Self:
        if self.measure == "success" and self.least_success is not None:
            raise ValueError("least_success: is for other measures than success; drop the key")
        return self

    @property
    def sign(self) -> int:
        """1 where more is better, -1 where less is."""
        better = self.direction or ("maximize" if self.measure == "success" else "minimize")
        return 1 if better == "maximize" else -1

    @property
    def needed(self) -> float:
        """The success rate from which trials are compared by the measure."""
        if self.measure == "success":
            return 0.0
        return LEAST_SUCCESS if self.least_success is None else self.least_success

    def rank(self, value: float | None, summary: Mapping[str, Any] | None) -> tuple[bool, float]:
        """The key by which trials are sorted, the greatest for the best, from a trial's value and summary."""
        success = summary["success_rate"] if summary is not None else 0.0
        if value is None or success < self.needed:
            return False, success
        return True, self.sign * value


class Sweep(Part):
    """One sweep, whole.

    set: keys of the experiment that are the same in every trial. Without `trials` it tries the whole grid;
    with it, so many draws of Optuna's `sampler`. They are proposed `batch` at a time, from the results of all
    earlier batches: so the same seed gives the same trials however many of them run at once. retries: how
    often a trial is tried again that failed or was lost.
    """

    name: Name
    description: str = ""
    experiment: str
    set: dict[str, Any] = Field(default={})
    parameters: Annotated[dict[str, Parameter], Field(min_length=1)]
    objective: Objective
    trials: Count | None = None
    sampler: Literal["tpe", "random"] = "tpe"
    batch: Count = 4
    seed: Seed = 0
    retries: Annotated[int, Field(ge=0, le=100)] = 2

    @model_validator(mode="after")
    def _is_a_grid_or_a_search(self) -> Self:
        for key, parameter in self.parameters.items():
            if self.trials is None and parameter.kind != "grid":
                raise ValueError(f"parameters.{key}: is drawn at random; give the number of draws as trials")
            if self.trials is not None and parameter.kind == "grid":
                raise ValueError(f"parameters.{key}: is a grid; drop trials, or make it a choice")
        grid = math.prod(len(parameter.grid or ()) for parameter in self.parameters.values())
        if self.trials is None and grid > MOST_TRIALS:
            raise ValueError(
                f"parameters: a grid of {grid:.3g} trials; at most {MOST_TRIALS}, or give trials"
            )
        return self


def load_sweep(name_or_path: str | Path) -> Sweep:
    """The sweep of a file, by path or by its bare name in configs/sweeps; UserError names the first fault."""
    path = find_config("sweeps", name_or_path)
    data = read_yaml(path)
    if isinstance(data.get("experiment"), str):
        data["experiment"] = config_beside(path, data["experiment"])
    return validated(path, Sweep, data)


def override(key: str, value: Any) -> str:
    """`key=value` as `load_experiment` takes it, every bit of the value kept."""
    text = yaml.safe_dump(value, default_flow_style=True, width=10**9).removesuffix("...\n").strip()
    return f"{key}={text}"
