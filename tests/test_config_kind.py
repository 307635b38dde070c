"""A file of another kind than a command needs is named as what it is, in one line."""

from collections.abc import Callable
from itertools import permutations
from pathlib import Path

import pytest
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.sweep.schema import load_sweep

from swamp_rl.boat import load_boat
from swamp_rl.config_kind import config_kind
from swamp_rl.course import load_course
from swamp_rl.design.hull_lines import load_hull
from swamp_rl.effects.levels import load_disturbances
from swamp_rl.energy.mission import load_mission
from swamp_rl.errors import UserError
from swamp_rl.files import config_names, find_config, read_yaml
from swamp_rl.guidance.path_file import load_path
from swamp_rl.identification.square_twin import load_vehicle
from swamp_rl.manoeuvres.plan import load_plan

READERS: dict[str, tuple[str, Callable[[Path], object]]] = {
    "boat": ("swamp-light", load_boat),
    "course": ("camogli", load_course),
    "path": ("eight", load_path),
    "mission": ("survey", load_mission),
    "trial": ("imo", load_plan),
    "design": ("swamp_hull", load_hull),
    "vehicle": ("typhoon", load_vehicle),
    "experiment": ("severe", load_experiment),
    "sweep": ("reservoir_grid", load_sweep),
    "disturbance": ("gusts", lambda path: load_disturbances(path, ())),
}
UNMARKED = {"calm", "elsewhere", "reversed", "thesis_figures"}
"""Levels without effects, and a file of printed figures that lies among the trials."""


@pytest.mark.parametrize(("given", "needed"), list(permutations(READERS, 2)))
def test_each_kind_in_place_of_each_other_is_one_line(given: str, needed: str) -> None:
    path = find_config(f"{given}s", READERS[given][0])
    with pytest.raises(UserError) as refused:
        READERS[needed][1](path)
    (line,) = str(refused.value).split("\n")
    named, is_needed = line.split("; ")
    assert named in (f"{path}: is a {given} file", f"{path}: is an {given} file")
    assert is_needed.startswith((f"a {needed} file is needed here", f"an {needed} file is needed here"))


@pytest.mark.parametrize("kind", READERS)
def test_the_shipped_files_are_known_by_their_keys(kind: str) -> None:
    names = set(config_names(f"{kind}s")) - UNMARKED
    assert {config_kind(read_yaml(find_config(f"{kind}s", name))) for name in names} == {kind}


def test_a_key_too_many_leaves_a_file_of_the_kind_that_is_needed(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text("name: mine\nspeed: 1.0\npieces: [{kind: line, to: [0.0, 9.0]}]\nmass: 3.0\nhull: {}\n")
    with pytest.raises(UserError, match="mass: unknown key"):
        load_path(path)


def test_a_boat_without_a_length_lacks_the_length_alone(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text("extends: swamp\nlength: null\nwind: null\ncurrent: null\njoypad: null\n")
    with pytest.raises(UserError) as refused:
        load_boat(path)
    assert str(refused.value) == f"{path}: length: is missing; add it"
