"""What the report of a fleet says of each boat and dataset."""

import html
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from swamp_rl.experiments.fleet.report import page
from swamp_rl.experiments.fleet.result import Fleet, Member
from swamp_rl.experiments.fleet.run import fleet_of
from swamp_rl.experiments.fleet.words import outcome_lines
from swamp_rl.experiments.fleet.work import RESULT

from swamp_rl.boat import load_boat
from swamp_rl.criticism.result import (
    Cause,
    Diagnosis,
    Extension,
    ForceCurve,
    Gain,
    HeldOut,
    Paired,
    Predictors,
)
from swamp_rl.runs import create_dataset
from swamp_rl.runs.schema import meta_of
from tests.support.fleets import cause, diagnosis


def fleet(folder: Path, found: Mapping[str, Diagnosis], boat_file: str | None = "swamp") -> Fleet:
    """A fleet of a dataset `BOAT day` for each diagnosis, compared with one boat file or with its own."""
    for name, one in found.items():
        (folder / name).mkdir(exist_ok=True)
        (folder / name / RESULT).write_text(one.model_dump_json())
    members = [
        Member(name=name, boat=name.split()[0], dataset=str(folder / name), boat_file=boat_file)
        for name in found
    ]
    return fleet_of(members, folder, {})


def text(found: Fleet) -> str:
    """The page's text, cells and lines apart."""
    return html.unescape(re.sub(r"<[^>]+>", "|", page(found))).replace("\N{NO-BREAK SPACE}", " ")


def gain() -> Cause:
    return cause("thruster_gain", "gain", 0.70647, 0.01011, 90.0).model_copy(update={"thruster": "port"})


def errors(*horizons: float, before: float = 9.0, after: float = 1.5) -> list[Gain]:
    paired = Paired(before=before, after=after, ci95=(1.0, 2.0))
    return [Gain(horizon_s=one, restarts=9, blocks="runs", position_rmse_m=paired) for one in horizons]


def behind(verdict: str = "unexplained", **more: Any) -> Diagnosis:
    """Of a boat file that is no better than a boat at rest."""
    poor = Predictors(horizon_s=10.0, boat_file=5.0, at_rest=4.0, constant_velocity=9.0, no_thrust=9.0)
    return diagnosis(predictors=[poor], verdict=verdict, **more)


def test_a_row_has_the_values_of_causes_and_minor_ones_with_their_errors_in_units(tmp_path: Path) -> None:
    mass = cause("mass", "mass", 38.867, 2.7, 9.0, "kg")
    bias = cause("heading_bias", "bias", math.radians(8.12), math.radians(0.25), 90.0, "rad")
    shown = text(fleet(tmp_path, {"red may": diagnosis(gain(), bias, minor=[mass])}))
    assert "|thruster gain (port): gain 0.706 ± 0.010|" in shown
    assert "|heading bias: bias 8.12 ± 0.25 degrees|" in shown
    assert "|minor: mass 38.9 ± 2.7 kg|" in shown


def test_a_row_has_what_cannot_be_distinguished_and_the_position_error(tmp_path: Path) -> None:
    drag = cause("resistance", "scale", 1.5, 0.07, 90.0)
    equal = [["current by_run + resistance", "current by_run + linear_drag"]]
    found = {
        "red may": diagnosis(drag, indistinguishable=equal, gain=errors(1.0, 10.0, 30.0)),
        "blue may": diagnosis(gain=errors(1.0, 10.0)),
    }
    whole = fleet(tmp_path, found)
    assert "|cannot be distinguished: resistance or linear drag|" in text(whole)
    assert "position error 10 s ahead [m]: boat file → extended boat" in text(whole)
    assert text(whole).count("|9 → 1.5|") == 2


def test_boats_without_a_cause_of_their_own_come_last_and_are_named(tmp_path: Path) -> None:
    current = cause("current", "north", 0.1, 0.01, 90.0, "m/s")
    weak = cause("yaw_inertia", "scale", 1.1, 0.1, 2.0)
    whole = fleet(
        tmp_path,
        {
            "ada may": diagnosis(current),
            "blue may": diagnosis(weak),
            "green may": diagnosis(minor=[cause("mass", "mass", 40.0, 1.0, 9.0, "kg")]),
            "red may": diagnosis(gain(), current),
        },
    )
    assert [(one.boat, one.causes, one.lesser) for one in whole.boats] == [
        ("red", ["thruster_gain port"], []),
        ("blue", [], ["yaw_inertia"]),
        ("green", [], ["mass"]),
        ("ada", [], []),
    ]
    assert "yaw inertia: scale 1.10 ± 0.10 (not kept)" in text(whole)
    lines = outcome_lines(whole)
    assert lines[0] == "red: thruster gain (port)" and "no cause of their own: ada" in lines
    assert "only minor causes, or not kept ones: blue (yaw inertia); green (mass)" in lines


def test_angles_that_differ_between_days_are_in_degrees_and_names_keep_their_hyphens(tmp_path: Path) -> None:
    angles = {"red 2026-05": math.radians(8.0), "red 2026-06": math.radians(-2.0)}
    days = {
        name: diagnosis(cause("heading_bias", "bias", angle, 0.001, 90.0, "rad"))
        for name, angle in angles.items()
    }
    whole = fleet(tmp_path, days)
    assert "red 2026-05 8.000 ± 0.057; red 2026-06 −2.000 ± 0.057" in text(whole)
    values = "red 2026-05 8.000 ± 0.057, red 2026-06 -2.000 ± 0.057"
    assert f"red: heading bias differs [degrees]: {values}" in outcome_lines(whole)


def test_a_boats_cause_says_in_how_many_explanations_it_is_where_no_day_tells_them_apart(
    tmp_path: Path,
) -> None:
    unsure = diagnosis(
        gain(), indistinguishable=[["thruster_gain port + mass", "throttle_dead_band port + mass"]]
    )
    days = {"red may": unsure, "red june": unsure, "blue may": unsure, "blue june": diagnosis(gain())}
    whole = fleet(tmp_path, days)
    assert "red: thruster gain (port) [in 1 of 2 explanations]" in outcome_lines(whole)
    assert "blue: thruster gain (port)" in outcome_lines(whole)
    assert "|thruster gain (port) [in 1 of 2 explanations]|" in text(whole)
    pairs = diagnosis(gain(), indistinguishable=[["thruster_gain port + mass", "mass", "thruster_gain port"]])
    found = outcome_lines(fleet(tmp_path, {"red may": pairs}))
    assert "red: thruster gain (port) [in 2 of 3 explanations]" in found


def sisters(sick: int, of: int, **healthy: Any) -> dict[str, Diagnosis]:
    """Boats, the first ones with a weak thruster, the others as given."""
    return {f"boat{k} may": diagnosis(gain()) if k < sick else diagnosis(**healthy) for k in range(of)}


BLIND: dict[str, Any] = {"unseen": ["thruster_gain port"]}
PUZZLED: dict[str, Any] = {"verdict": "unexplained"}


@pytest.mark.parametrize(
    ("sick", "of", "others", "rather"),
    [
        (3, 3, {}, True),
        (3, 4, BLIND, True),
        (3, 4, {"hidden": ["thruster_gain port"]}, True),
        (3, 4, PUZZLED, True),
        (3, 4, {"minor": [gain()]}, True),
        (3, 4, {}, False),
        (4, 6, {}, False),
        (2, 6, BLIND, False),
        (2, 2, {}, False),
    ],
)
def test_a_cause_of_most_boats_that_no_other_is_free_of_is_rather_an_error_of_their_common_boat_file(
    tmp_path: Path, sick: int, of: int, others: dict[str, Any], rather: bool
) -> None:
    whole = fleet(tmp_path, sisters(sick, of, **others))
    assert [one.in_boat_file for one in whole.shared] == [rather]
    assert ("an error of the common boat file" in text(whole)) == rather
    assert any("likely an error of their common boat file" in one for one in outcome_lines(whole)) == rather


def test_causes_that_a_written_force_was_fitted_in_place_of_are_no_findings(
    tmp_path: Path,
) -> None:
    mass = cause("mass", "mass", 60.0, 1.0, 200.0, "kg")
    curve = ForceCurve(
        component="surge", covariate="heading", knots=[0.0], values=[1.0], standard_errors=[0.1], units=["N"]
    )
    confirmed = HeldOut(gain=90.0, low=1.0, level=0.999)
    force = Extension(curves=[curve], beside=[gain()], held_out=confirmed, written=True)
    partial = diagnosis(gain(), mass, verdict="unexplained", extension=force)
    unwritten = partial.model_copy(update={"extension": force.model_copy(update={"written": False})})
    whole = fleet(tmp_path, {"red may": partial, "blue may": unwritten})
    causes = {one.boat: one.causes for one in whole.boats}
    assert causes["red"] == ["force_curve surge of heading", "thruster_gain port"]
    assert causes["blue"] == ["mass", "thruster_gain port"]


@pytest.mark.parametrize(("other", "rather"), [("swamp", True), ("swamp-light", False)])
def test_boat_files_of_the_datasets_are_a_common_one_where_their_numbers_are_the_same(
    tmp_path: Path, other: str, rather: bool
) -> None:
    found = sisters(3, 3)
    for name, vehicle in zip(found, ("swamp", "swamp", other), strict=True):
        create_dataset(tmp_path / name, meta_of(load_boat(vehicle), vehicle, 10.0, "measured"))
    assert [one.in_boat_file for one in fleet(tmp_path, found, boat_file=None).shared] == [rather]


def test_a_boat_file_that_predicts_no_better_than_a_trivial_predictor_is_warned_of(tmp_path: Path) -> None:
    whole = fleet(tmp_path, {"red may": behind(), "blue may": behind(), "green may": diagnosis()})
    (sentence,) = [one for one in outcome_lines(whole) if "trivial predictor" in one]
    assert sentence.startswith("In 2 of 3 datasets (red may, blue may) the boat file predicts positions no")
    assert "positions 10 s ahead no better than" in sentence and "5 m against 4 m" in sentence
    assert "If its numbers are guesses, fit them before reading causes: swamp-rl identify boat" in sentence
    assert sentence in text(whole)


def test_of_boats_that_one_file_fits_but_for_a_few_those_are_named(tmp_path: Path) -> None:
    found = {f"boat{k} may": diagnosis() for k in range(4)} | {"red may": behind()}
    (sentence,) = [one for one in outcome_lines(fleet(tmp_path, found)) if "trivial predictor" in one]
    assert sentence.startswith("In 1 of 5 datasets (red may)") and "differ from it most" in sentence
