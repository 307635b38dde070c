"""Estimates for catamarans: the published numbers of SWAMP and of the Otter from their sizes."""

from pathlib import Path
from typing import Any

import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import annotated, boat_file
from swamp_rl.errors import UserError
from swamp_rl.simulator import parameters
from tests.support.boats import forces_on_hull
from tests.support.command_line import Call
from tests.support.command_line import call as call  # the fixture

SWAMP = {"length": 1.24, "breadth": 1.1, "mass": 58.0, "thrust": 60.0, "draught": 0.14, "demihull": 0.24}
FLAT = ("--kind", "twin-fixed", "--length", "1.2", "--breadth", "0.93", "--mass", "15", "--thrust", "105")


def catamaran(tmp_path: Path, kind: str, **sizes: float) -> Boat:
    path = tmp_path / "catamaran.yaml"
    made: dict[str, Any] = boat_file("catamaran", kind, **sizes)
    path.write_text(annotated(made, "A catamaran."), encoding="utf-8")
    return load_boat(path)


def test_swamp_from_its_sizes_has_the_numbers_of_its_thesis(tmp_path: Path) -> None:
    boat, thesis = catamaran(tmp_path, "four-azimuths", **SWAMP), load_boat("swamp")
    assert boat.inertia_z == pytest.approx(thesis.inertia_z, rel=0.06)
    assert boat.hull.n_v == pytest.approx(thesis.hull.n_v, abs=0.005)
    assert boat.hull.y_v == pytest.approx(thesis.hull.y_v, abs=0.01)
    assert boat.hull.spacing == pytest.approx(thesis.hull.spacing, rel=0.08)  # it has 0.80 to 0.86 m
    assert boat.added_inertia_yaw == pytest.approx(thesis.added_inertia_yaw, rel=0.5)


def test_an_otter_floats_as_deep_as_published_for_its_pontoons(tmp_path: Path) -> None:
    """L = 2.0 m, B = 1.08 m, pontoons of 0.25 m, 55 kg: T = 0.134 m at C_B = 0.4 (Fossen 2021, otter.m)."""
    boat = catamaran(tmp_path, "twin-fixed", length=2.0, breadth=1.08, mass=55.0, thrust=220.0, demihull=0.25)
    assert boat.draught == pytest.approx(0.134 * 0.4 / 0.5, rel=0.01)
    assert boat.thrusters[0].y == pytest.approx(-0.415)  # published: 0.395 m


def test_each_demihull_meets_its_own_speed_in_a_turn(tmp_path: Path) -> None:
    boat = catamaran(tmp_path, "four-azimuths", **SWAMP)
    one = boat.model_copy(update={"hull": boat.hull.model_copy(update={"spacing": 0.0})})
    damped, bare = (forces_on_hull(each, parameters(each)[0], 1.0, 0.0, 0.5)[2] for each in (boat, one))
    assert damped < bare < 0.0


def test_two_hulls_that_do_not_fit_in_the_breadth_are_refused() -> None:
    sizes = SWAMP | {"demihull": 0.6}
    with pytest.raises(UserError, match=r"--demihull 0\.6: two such hulls do not fit in --breadth 1\.1"):
        boat_file("catamaran", "twin-fixed", **sizes)  # type: ignore[arg-type]


def test_a_boat_as_flat_as_two_hulls_taken_as_one_is_written_with_a_warning(call: Call) -> None:
    code, out, _ = call("boat", "new", "flat", *FLAT)
    assert code == 0 and "draught 0.0262 m is 1/35 of the breadth" in out and "--demihull" in out
    code, out, _ = call("boat", "new", "catamaran", *FLAT, "--demihull", "0.2")
    assert code == 0 and "of the breadth" not in out
