"""Every count has an upper end: absurd ones are refused by key or option before any work."""

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer
import yaml
from swamp_rl.experiments.cli.app import app
from swamp_rl.experiments.config.json_schema import schema_text
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.sweep.schema import Sweep, load_sweep

from swamp_rl.course.schema import Course
from swamp_rl.design import HullDesign, MatchDesign, PumpJetDesign
from swamp_rl.energy.mission import Mission
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.plan import Plan
from swamp_rl.runs.resample import resampled

COUNTED = ("evaluation.episodes", "evaluation.shown", "data.record.good", "data.record.failed")


def integers(schema: Any, where: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Every place of a JSON schema at which a whole number is read."""
    if isinstance(schema, dict):
        if schema.get("type") == "integer" and "const" not in schema and "enum" not in schema:
            yield where, schema
        for key, inner in schema.items():
            yield from integers(inner, f"{where}.{key}")
    elif isinstance(schema, list):
        for number, inner in enumerate(schema):
            yield from integers(inner, f"{where}.{number}")


MODELS: dict[str, Any] = {
    "sweep": Sweep,
    "trials": Plan,
    "course": Course,
    "mission": Mission,
    "pump-jet": PumpJetDesign,
    "hull": HullDesign,
    "match": MatchDesign,
}


@pytest.mark.parametrize("model", ["experiment", *MODELS])
def test_every_whole_number_of_a_file_has_a_greatest_value(model: str) -> None:
    schema = json.loads(schema_text()) if model == "experiment" else MODELS[model].model_json_schema()
    endless = [
        where
        for where, found in integers(schema)
        if not {"maximum", "exclusiveMaximum"} & found.keys() and ".Parameter." not in where
    ]
    assert endless == []


def whole_numbers(command: Any, above: str = "") -> Iterator[tuple[str, Any]]:
    """The greatest value of each option of the command line that is a whole number, by verb and name."""
    for name, inner in getattr(command, "commands", {}).items():
        yield from whole_numbers(inner, f"{above}{name} ")
    for option in command.params:
        if option.type_descriptor.annotation in (int, int | None):
            yield f"{above}{option.name}", option.max


def test_every_whole_number_of_the_command_line_has_a_greatest_value() -> None:
    known = dict(whole_numbers(typer.main.get_command(app)))
    assert known["record-scripted count"] == 100_000
    # Those of trials are checked as a plan's are; a sender is only compared with what the file holds.
    checked = ("trial turning-circle turns", "trial zig-zag executes", "runs import sender")
    assert [name for name, most in known.items() if most is None and name not in checked] == []


@pytest.mark.parametrize("key", COUNTED)
def test_an_absurd_count_of_an_experiment_is_refused_by_key(key: str) -> None:
    begun = time.process_time()
    for value in ("1000000000000", "1e12", "9" * 99):
        with pytest.raises(UserError, match=key.replace(".", r"\.")):
            load_experiment("smoke", [f"{key}={value}"])
    assert time.process_time() - begun < 5.0


def test_a_grid_of_more_trials_than_could_ever_run_is_refused(tmp_path: Path) -> None:
    grid = {f"evaluation.key{i}": {"grid": [1, 2, 3, 4, 5]} for i in range(60)}
    objective = {"pilot": "scripted", "level": "calm"}
    data = {"name": "s", "experiment": "smoke", "parameters": grid, "objective": objective}
    (tmp_path / "s.yaml").write_text(yaml.safe_dump(data))
    with pytest.raises(UserError, match=r"a grid of 8.67e\+41 trials"):
        load_sweep(tmp_path / "s.yaml")


@pytest.mark.parametrize("rate", [1e9, 1e300])
def test_more_rows_than_fit_into_memory_are_not_resampled(rate: float) -> None:
    columns = {"time": np.array([0.0, 1.0]), "north": np.zeros(2)}
    with pytest.raises(UserError, match="resample at a lower rate"):
        resampled(columns, rate)


def test_more_pilots_than_can_be_compared_are_refused_at_once() -> None:
    many = "{" + ", ".join(f"p{i}: {{kind: nope}}" for i in range(20_000)) + "}"
    begun = time.process_time()
    with pytest.raises(UserError, match="pilots: there are 200"):
        load_experiment("smoke", [f"pilots={many}"])
    assert time.process_time() - begun < 5.0
