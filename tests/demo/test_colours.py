"""A driver has one colour, whoever else is shown."""

from itertools import combinations

from swamp_rl.demo.colours import DRIVERS, OTHERS, PEOPLE, driver_colours


def test_a_known_driver_has_the_same_colour_in_any_company() -> None:
    for company in combinations(DRIVERS, 3):
        assert driver_colours(company) == {name: DRIVERS[name] for name in company}
    assert driver_colours(["human Anna"])["human Anna"] == DRIVERS["human"]


def test_of_drivers_that_begin_alike_one_keeps_the_colour_whatever_their_order() -> None:
    names = ["scripted kat", "scripted barge", "ppo"]
    found = driver_colours(names)
    assert found == driver_colours(names[::-1])
    assert found["scripted barge"] == DRIVERS["scripted"] and len(set(found.values())) == 3


def test_unknown_drivers_have_colours_of_their_own_whatever_their_order() -> None:
    names = ["mine", "yours", "reservoir", "theirs"]
    found = driver_colours(names)
    assert found == driver_colours(names[::-1])
    assert len(set(found.values())) == 4 and list(found) == names


def test_more_drivers_than_colours_repeat_some() -> None:
    found = driver_colours([f"pilot {n}" for n in range(20)])
    assert set(found.values()) == set(OTHERS)


def test_pilots_of_any_name_have_the_same_colours_beside_the_data_and_without() -> None:
    pilots = [f"pilot {n}" for n in range(8)]
    for source in PEOPLE:
        beside = driver_colours([source, *pilots])
        assert {name: beside[name] for name in pilots} == driver_colours(pilots)
