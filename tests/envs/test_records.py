"""Boats that are made up alike share one record type, which numba finds at once."""

from swamp_rl.envs.single import GatesEnv


def test_boats_with_as_many_thrusters_have_one_record_type() -> None:
    one, other = GatesEnv(boat="swamp").fleet, GatesEnv(boat="swamp-thesis", disturbances="severe").fleet
    assert one.params.dtype is other.params.dtype
    assert one.boats.dtype is other.boats.dtype


def test_another_number_of_thrusters_is_another_record_type() -> None:
    one, other = GatesEnv(boat="swamp").fleet, GatesEnv(boat="esso_osaka").fleet
    assert one.boats.dtype != other.boats.dtype
