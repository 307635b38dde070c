"""Boat files laid over one another."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.merge import leaves, merge
from swamp_rl.errors import UserError
from tests.support.from_scratch import TWIN, written

TREES = st.recursive(
    st.integers() | st.lists(st.integers(), max_size=3),
    lambda inner: st.dictionaries(st.sampled_from("abcd"), inner, min_size=1, max_size=4),
    max_leaves=12,
)
SECTIONS = st.dictionaries(st.sampled_from("abcd"), TREES, max_size=4)


def extended(folder: Path, text: str, name: str = "mine") -> Boat:
    (folder / f"{name}.yaml").write_text(text)
    return load_boat(folder / f"{name}.yaml")


def test_a_file_that_changes_nothing_is_the_boat_it_extends(tmp_path: Path) -> None:
    assert extended(tmp_path, "extends: swamp\nname: swamp\n") == load_boat("swamp")


def test_an_extending_file_takes_its_own_name_not_the_others(tmp_path: Path) -> None:
    assert extended(tmp_path, "extends: swamp\n").name == "mine"


def test_a_bare_number_counts_as_assumed_by_the_file_that_sets_it(tmp_path: Path) -> None:
    boat = extended(tmp_path, "extends: swamp\nhull: {y_v: -0.6}\nthrusters: {bs: {x: 0.36}}\n")
    assert (boat.hull.y_v, boat.hull.n_v) == (-0.6, -0.226)
    for key, unit in {"hull.y_v": "1", "thrusters.bs.x": "m"}.items():
        given = boat.provenance[key]
        assert (given.unit, given.provenance, given.source) == (unit, "assumed", "set in mine.yaml")
    assert boat.provenance["thrusters.bp.x"].provenance == "measured"


def test_thrusters_are_changed_and_added_by_name(tmp_path: Path) -> None:
    boat = extended(
        tmp_path,
        "extends: swamp\n"
        "thrusters:\n"
        "  fan: {kind: fixed, x: 0.3, y: 0, azimuth_min: 1.5, azimuth_max: 1.5, astern_linear: 6}\n"
        "  ss: {thrust_quadratic: 6.1}\n",
    )
    assert boat.thruster_names == ("bs", "bp", "ss", "sp", "fan")
    assert [thruster.thrust_quadratic for thruster in boat.thrusters] == [12.2, 12.2, 6.1, 12.2, 12.2]
    assert [thruster.reverses for thruster in boat.thrusters] == [False] * 4 + [True]


def test_thrusters_as_a_list_replace_those_of_the_boat_extended(tmp_path: Path) -> None:
    text = "extends: swamp\nthrusters: [{name: bs, x: 0.3, y: 0.1}]\njoypad: {thrusters: [bs]}\n"
    boat = extended(tmp_path, text)
    assert [(item.name, item.x, item.y) for item in boat.thrusters] == [("bs", 0.3, 0.1)]
    assert boat.provenance["thrusters.bs.x"].source == "set in mine.yaml"
    assert boat.provenance["thrusters.bs.thrust_quadratic"].source == "thesis table 5.5, at 1185 RPM"


def test_null_removes_a_key_a_thruster_and_what_the_common_block_has(tmp_path: Path) -> None:
    text = (
        "extends: swamp\nthruster_model: {azimuth_min: -3.0, azimuth_max: 3.0, nozzle_area: null}\n"
        "thrusters: {bp: {azimuth_min: null, azimuth_max: null}, sp: null}\n"
    )
    boat = extended(tmp_path, text)
    assert boat.thruster_names == ("bs", "bp", "ss")
    assert [thruster.endless for thruster in boat.thrusters] == [False, True, False]
    assert boat.thrusters[0].nozzle_area == 0.0
    assert not {"thrusters.bs.nozzle_area", "thrusters.bp.azimuth_min"} & boat.provenance.keys()
    back = extended(tmp_path, "extends: mine.yaml\nthruster_model: {nozzle_area: 0.001}\n", "again")
    assert back.thrusters[0].nozzle_area == 0.001 and back.thruster_names == boat.thruster_names


def test_thrusters_may_stand_by_name_in_a_file_that_extends_nothing(tmp_path: Path) -> None:
    by_name = {item["name"]: {k: v for k, v in item.items() if k != "name"} for item in TWIN["thrusters"]}
    listed = load_boat(written(tmp_path, "twin"))
    assert load_boat(written(tmp_path, "twin", thrusters=by_name)) == listed


def test_the_common_block_reaches_every_thruster_that_does_not_say_otherwise(tmp_path: Path) -> None:
    extended(tmp_path, "extends: swamp\nthrusters: {sp: {azimuth_time_constant: 0.5}}\n", "lower")
    boat = extended(tmp_path, "extends: lower.yaml\nthruster_model: {azimuth_time_constant: 0.3}\n")
    assert [thruster.azimuth_time_constant for thruster in boat.thrusters] == [0.3, 0.3, 0.3, 0.5]
    assert boat.provenance["thrusters.bs.azimuth_time_constant"].source == "set in mine.yaml"
    assert boat.provenance["thrusters.sp.azimuth_time_constant"].source == "set in lower.yaml"


def test_c_d_follows_the_draught_through_yoshimuras_regression_unless_given(tmp_path: Path) -> None:
    boat = extended(tmp_path, "extends: swamp\ndraught: 0.2\n")
    assert boat.hull.c_d == pytest.approx(1.848 - 0.0591 * 6.2)
    assert extended(tmp_path, "extends: swamp\ndraught: 0.2\nhull: {c_d: 1.0}\n").hull.c_d == 1.0
    assert (
        extended(tmp_path, "extends: mine.yaml\nhull: {c_d: yoshimura}\n", "again").hull.c_d == boat.hull.c_d
    )


def test_effects_follow_those_of_the_boat_extended(tmp_path: Path) -> None:
    extended(tmp_path, "extends: swamp\neffects: [{effect: current, north: 0.1}]\n", "lower")
    boat = extended(
        tmp_path, "extends: lower.yaml\neffects: [{effect: thruster_gain, thruster: bs, gain: 0.7}]\n"
    )
    effects = [(entry.effect.name, entry.thruster, dict(entry.values)) for entry in boat.effects]
    assert effects == [
        ("current", None, {"north": 0.1, "east": 0.0}),
        ("thruster_gain", "bs", {"gain": 0.7}),
    ]
    assert hash(boat) == hash(load_boat(tmp_path / "mine.yaml"))


def test_a_long_chain_of_files_ends_with_the_topmost_value(tmp_path: Path) -> None:
    below = "swamp"
    for number in range(30):
        extended(tmp_path, f"extends: {below}\nmass: {40 + number}\n", f"boat{number}")
        below = f"boat{number}.yaml"
    assert load_boat(tmp_path / below).mass == 69.0


def test_files_that_extend_each_other_are_refused_with_the_way_round(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("extends: b.yaml\n")
    (tmp_path / "b.yaml").write_text("extends: ./a.yaml\n")
    with pytest.raises(Exception, match=r"a\.yaml -> .*b\.yaml -> .*a\.yaml: extends forms a cycle"):
        load_boat(tmp_path / "a.yaml")


def test_a_list_of_part_of_a_thruster_is_refused_with_how_to_change_one(tmp_path: Path) -> None:
    own = "thrusters: [{name: bs, kind: azimuth}]\n"
    with pytest.raises(
        UserError, match=r"bs.x: is missing; add it, or write thrusters: {NAME: {KEY: VALUE}} \("
    ):
        extended(tmp_path, f"extends: swamp\n{own}")
    with pytest.raises(UserError, match=r"bs.x: is missing; add it($|\n)"):
        extended(tmp_path, f"length: 1.0\n{own}")


@given(under=SECTIONS, over=SECTIONS)
def test_what_the_upper_file_says_holds_and_the_rest_stays(
    under: dict[str, Any], over: dict[str, Any]
) -> None:
    merged = dict(leaves(merge(under, over)))
    upper = dict(leaves(over))
    assert upper.items() <= merged.items()
    for key, value in leaves(under):
        hidden = any(key[: len(other)] == other[: len(key)] for other in upper)
        assert hidden or merged[key] == value


@given(tree=SECTIONS)
def test_laying_a_file_on_itself_or_on_nothing_changes_nothing(tree: dict[str, Any]) -> None:
    assert merge(tree, tree) == merge({}, tree) == merge(tree, {}) == tree
