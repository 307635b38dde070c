"""The draught of a boat from its load."""

from pathlib import Path

import pytest
from swamp_rl.experiments.reports.design_hull import write_hull

from swamp_rl.boat import load_boat
from swamp_rl.boat.digest import boat_digest
from swamp_rl.boat.estimate import annotated
from swamp_rl.boat.estimate import boat_file as estimated
from swamp_rl.design import draught_of, load_hull
from swamp_rl.errors import UserError
from swamp_rl.simulator.reference import reference_of

TABLE = "loading: {density: 1025.0, mass: [20.0, 40.0, 60.0], draught: [0.05, 0.10, 0.14]}\n"


def boat_file(folder: Path, text: str) -> Path:
    path = folder / "mine.yaml"
    path.write_text(f"extends: swamp\nname: mine\n{text}")
    return path


def test_the_draught_is_that_of_the_mass_in_the_table(tmp_path: Path) -> None:
    boat = load_boat(boat_file(tmp_path, f"mass: 50.0\ndraught: loading\n{TABLE}"))
    assert boat.draught == pytest.approx(0.12)
    assert boat.hull.c_d == pytest.approx(-0.0591 * 1.24 / 0.12 + 1.848)


def test_lighter_water_lets_the_boat_sink_deeper(tmp_path: Path) -> None:
    text = f"mass: 50.0\ndraught: loading\nwater_density: 1000.0\n{TABLE}"
    assert load_boat(boat_file(tmp_path, text)).draught == pytest.approx(0.12 + 1.25 * 0.04 / 20.0)


def test_a_designed_hull_gives_the_draught_of_any_load(tmp_path: Path) -> None:
    write_hull(tmp_path / "hull", "swamp_hull", "swamp")
    mine = tmp_path / "light.yaml"
    mine.write_text("extends: hull/boat.yaml\nname: light\nmass: 48.0\ndraught: loading\n")
    assert load_boat(mine).draught == pytest.approx(draught_of(load_hull("swamp_hull"), 48.0), abs=5e-4)


def test_a_designed_hull_keeps_the_resistance_of_coefficients(tmp_path: Path) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text(annotated(estimated("mine", "twin-fixed", 1.24, 1.1, 57.0, 40.0), "Of one hull."))
    write_hull(tmp_path / "hull", "swamp_hull", str(mine))
    before, after = load_boat(mine), load_boat(tmp_path / "hull" / "boat.yaml")
    assert after.draught != pytest.approx(before.draught, rel=0.01)
    assert reference_of(after).speed == pytest.approx(reference_of(before).speed, rel=1e-3)


def test_a_table_that_is_not_used_changes_no_digest(tmp_path: Path) -> None:
    assert boat_digest(load_boat(boat_file(tmp_path, TABLE))) == boat_digest(load_boat("swamp"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("draught: loading\n", "no section loading"),
        (f"mass: 80.0\ndraught: loading\n{TABLE}", "20 to 60 kg"),
        ("draught: loading\nloading: {density: 1025.0, mass: [20.0], draught: [0.05]}\n", "two or more"),
        (
            "draught: loading\nloading: {density: 1025.0, mass: [20.0, 10.0], draught: [0.1, 0.2]}\n",
            "increase",
        ),
        ("draught: lading\n", "draught"),
        (f"mass: heavy\ndraught: loading\n{TABLE}", "mass"),
    ],
)
def test_what_gives_no_draught_is_refused_by_its_key(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(UserError, match=r"mine\.yaml") as refused:
        load_boat(boat_file(tmp_path, text))
    assert message in str(refused.value)
