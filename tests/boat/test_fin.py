"""A fin of an estimated boat: its lift by hand, and the circles that it makes those of boats under way."""

import math
from pathlib import Path
from typing import Any

import pytest
from swamp_rl.experiments.reports.boat_check import turning_warning

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import annotated, boat_file
from swamp_rl.errors import UserError
from swamp_rl.simulator import parameters
from tests.support.boats import forces_on_hull
from tests.support.command_line import Call
from tests.support.command_line import call as call  # the fixture

SKIFF = {"length": 4.0, "breadth": 1.6, "mass": 300.0, "thrust": 400.0}
AREA = 0.04  # m2
WORDS = [word for name, value in SKIFF.items() for word in (f"--{name}", value)]


def skiff(tmp_path: Path, kind: str, **given: Any) -> Boat:
    path = tmp_path / "skiff.yaml"
    path.write_text(annotated(boat_file("skiff", kind, **SKIFF, **given), "A skiff."), encoding="utf-8")
    return load_boat(path)


@pytest.mark.parametrize(("v", "r"), [(0.1, 0.0), (0.0, 0.1), (-0.2, 0.05)])
def test_a_fin_at_the_stern_adds_the_lift_of_a_flat_plate_there(tmp_path: Path, v: float, r: float) -> None:
    bare, finned = (skiff(tmp_path, "outboard", **fin) for fin in ({}, {"fin": AREA}))
    u, at = 2.0, -2.0
    slope = 6.13 * 1.5 / (2.25 + 1.5)
    lift = -0.5 * 1025.0 * AREA * slope * u * (v + at * r)
    before, after = (forces_on_hull(boat, parameters(boat)[0], u, v, r) for boat in (bare, finned))
    added = [more - less for more, less in zip(after, before, strict=True)]
    assert added == pytest.approx([0.0, lift, at * lift], rel=2e-3, abs=0.02)  # the file has four digits


def test_the_area_of_a_fin_is_a_guess_that_a_fit_may_correct_by_its_coefficients(tmp_path: Path) -> None:
    bare, guessed, half = (
        skiff(tmp_path, "outboard", **fin) for fin in ({}, {"fin": AREA}, {"fin": AREA / 2})
    )
    for name in ("y_v", "y_r", "n_v", "n_r"):
        spread, before = (boat.provenance[f"hull.{name}"].sd for boat in (guessed, bare))
        assert isinstance(spread, float) and isinstance(before, float) and spread > before
        assert abs(getattr(guessed.hull, name) - getattr(half.hull, name)) < 1.25 * spread
    assert guessed.provenance["hull.x_vr"].sd == bare.provenance["hull.x_vr"].sd


@pytest.mark.parametrize("kind", ["outboard", "waterjet", "azimuth", "four-azimuths"])
def test_with_a_fin_a_steered_boat_turns_as_boats_under_way_do(tmp_path: Path, kind: str) -> None:
    without = turning_warning(skiff(tmp_path, kind))
    assert without is not None and "give the lateral area" in without
    assert turning_warning(skiff(tmp_path, kind, fin=AREA)) is None


@pytest.mark.parametrize("fin", [0.0, -0.1, math.nan, 0.2])
def test_an_area_that_no_fin_has_is_refused_by_its_option(fin: float) -> None:
    with pytest.raises(UserError, match="--fin"):
        boat_file("skiff", "outboard", **SKIFF, fin=fin)


def test_a_new_boat_that_spins_is_written_with_a_warning(call: Call) -> None:
    code, message, _ = call("boat", "new", "skiff", "--kind", "outboard", *WORDS)
    assert code == 0 and Path("skiff.yaml").is_file()
    (warning,) = message.splitlines()[1:]
    assert warning.startswith("skiff.yaml: warning: full ahead at +30 deg: drift angle 1")
    _, message, _ = call("boat", "new", "finned", "--kind", "outboard", *WORDS, "--fin", AREA)
    assert len(message.splitlines()) == 1
