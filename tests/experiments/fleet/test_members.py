"""The datasets of a fleet: which are days of one boat, and names that are none."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from swamp_rl.experiments.fleet import members_of

from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.runs import create_dataset
from swamp_rl.runs.schema import meta_of


def test_a_boat_is_a_folder_where_datasets_lie_in_several(tmp_path: Path) -> None:
    for boat in ("red", "blue"):
        (tmp_path / boat / "may").mkdir(parents=True)
    several = members_of([tmp_path / "red" / "may", tmp_path / "blue" / "may"])
    assert [(one.name, one.boat) for one in several] == [("blue_may", "blue"), ("red_may", "red")]
    alone = members_of([tmp_path / "red", tmp_path / "blue"])
    assert [(one.name, one.boat) for one in alone] == [("blue", "blue"), ("red", "red")]


def test_folders_of_the_same_name_are_boats_told_apart_by_more_of_their_paths(tmp_path: Path) -> None:
    given = [tmp_path / name for name in ("Lot A/data/day 1", "Lot B/data/day 1", "Lot B/red/day 1")]
    for dataset in given:
        dataset.mkdir(parents=True)
    assert [(one.name, one.boat) for one in members_of(given)] == [
        ("Lot A_data_day 1", "Lot A/data"),
        ("Lot B_data_day 1", "Lot B/data"),
        ("red_day 1", "red"),
    ]


@pytest.mark.parametrize(
    "names", [("Red", "red"), ("fast_red/may", "fast/red_may"), ("a/Red/may", "a/red/may")]
)
def test_two_datasets_that_would_have_one_folder_are_both_named(tmp_path: Path, names: Sequence[str]) -> None:
    given = [tmp_path / name for name in names]
    for dataset in given:
        dataset.mkdir(parents=True)
    with pytest.raises(UserError) as refused:
        members_of(given)
    assert str(refused.value).startswith(f"{given[0]} and {given[1]}: both would be named")


def test_a_dataset_is_given_twice_by_the_path_of_a_link_too(tmp_path: Path) -> None:
    (tmp_path / "red" / "may").mkdir(parents=True)
    (tmp_path / "blue").symlink_to(tmp_path / "red")
    given = [tmp_path / boat / "may" for boat in ("red", "blue")]
    with pytest.raises(UserError, match=f"^{given[0]} and {given[1]}: are the same folder; name each"):
        members_of(given)


def test_datasets_of_one_folder_that_name_other_vehicles_are_no_days_of_one_boat(tmp_path: Path) -> None:
    boat = load_boat("swamp")
    for day, vehicle in {"may": "swamp", "june": "swamp", "july": "swamp-light"}.items():
        create_dataset(tmp_path / "red" / day, meta_of(boat, vehicle, 10.0, "simulated"))
    create_dataset(tmp_path / "blue" / "may", meta_of(boat, "swamp", 10.0, "simulated"))
    given = [tmp_path / name for name in ("red/may", "red/june", "red/july", "blue/may")]
    assert {one.name: one.boat for one in members_of(given)} == {
        "blue_may": "blue",
        "red_july": "red/swamp-light",
        "red_june": "red/swamp",
        "red_may": "red/swamp",
    }
    assert {one.boat for one in members_of(given, boat="swamp")} == {"red", "blue"}


@pytest.mark.parametrize("name", [".hidden", "two\nlines", "back\\slash", "n" * 210])
def test_a_dataset_whose_folder_has_an_odd_name_is_refused_in_one_line(tmp_path: Path, name: str) -> None:
    with pytest.raises(UserError) as refused:
        members_of([tmp_path / name])
    assert str(refused.value).isprintable() and "rename it" in str(refused.value)
