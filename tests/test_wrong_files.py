"""Values that no file of any kind may hold: each is explained in one line, in words that users know."""

import copy
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.sweep.schema import load_sweep

from swamp_rl.course import load_course
from swamp_rl.design.pump_jet import load_pump_jet
from swamp_rl.effects.levels import load_disturbances
from swamp_rl.energy.mission import load_mission
from swamp_rl.errors import UserError
from swamp_rl.files import find_config, read_yaml
from swamp_rl.guidance.path_file import load_path
from swamp_rl.manoeuvres.plan import load_plan

READERS: dict[str, tuple[str, Callable[[Path], object]]] = {
    "courses": ("camogli", load_course),
    "designs": ("swamp_pump_jet", load_pump_jet),
    "experiments": ("smoke", load_experiment),
    "disturbances": ("elsewhere", lambda path: load_disturbances(path, ("bs", "bp", "ss", "sp"))),
    "missions": ("survey", load_mission),
    "paths": ("river", load_path),
    "sweeps": ("reservoir_grid", load_sweep),
    "trials": ("ittc_swamp", load_plan),
}
WRONG = (None, "many", -1, 1.5, True, [], [1, 2], {}, {"a": 1}, "3 m", "")
FOREIGN = re.compile(
    r"[Ii]nput |valid |discriminator|dictionary|tuple|instance|parse|pydantic|string|None\b|True\b|False\b"
)
"""Words of Python and of its libraries."""


def changed(data: Any, wrong: object) -> Iterator[Any]:
    """Copies of `data`, in each of which another one of the first values on every level is wrong."""
    for key in list(data)[:4] if isinstance(data, dict) else range(min(len(data), 1)):
        yield _with(data, key, wrong)
        if isinstance(data[key], dict | list) and data[key]:
            yield from (_with(data, key, inner) for inner in changed(data[key], wrong))


def _with(data: Any, key: Any, value: object) -> Any:
    whole = copy.deepcopy(data)
    whole[key] = value
    return whole


def test_a_fault_inside_one_of_several_kinds_is_reported_by_the_key_that_the_file_has(tmp_path: Path) -> None:
    path = tmp_path / "path.yaml"
    path.write_text("name: a\nspeed: 1\npieces: [{kind: lawn_mower, length: -1, lines: 2, spacing: 5}]\n")
    with pytest.raises(UserError, match=r"path.yaml: pieces\.0\.length: must be at least 0.1, not -1"):
        load_path(path)


@pytest.mark.parametrize("kind", READERS)
def test_what_a_file_must_not_hold_is_explained_without_words_of_python(kind: str, tmp_path: Path) -> None:
    shipped, read = READERS[kind]
    data = read_yaml(find_config(kind, shipped))
    lines = []
    for wrong in WRONG:
        for number, content in enumerate(changed(data, wrong)):
            path = tmp_path / f"{number}.yaml"
            path.write_text(yaml.safe_dump(content, sort_keys=False))
            try:
                read(path)
            except UserError as error:
                lines += [line.replace(str(tmp_path), "") for line in str(error).split("\n")]
    assert lines
    assert [line for line in lines if FOREIGN.search(line)] == []
