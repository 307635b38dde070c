"""A ship that passes few lengths in the longest windows of a fit."""

from pathlib import Path

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.estimate import annotated, boat_file
from swamp_rl.boat_fit.report import short_windows

TANKER = {"length": 320.0, "breadth": 58.0, "draught": 20.8, "mass": 3.2e8, "thrust": 2.7e6, "top_speed": 8.0}


def tanker(folder: Path, scale: float) -> Boat:
    """A tanker, or a model of it by Froude's law."""
    powers = {"mass": 3.0, "thrust": 3.0, "top_speed": 0.5}
    sizes = {name: value / scale ** powers.get(name, 1.0) for name, value in TANKER.items()}
    path = folder / "tanker.yaml"
    content = boat_file("tanker", "propeller-rudder", **sizes)
    path.write_text(annotated(content, "a test"), encoding="utf-8")
    return load_boat(path)


def test_a_ship_at_full_scale_is_advised_to_be_scaled_and_its_model_is_not(tmp_path: Path) -> None:
    (line,) = short_windows(tanker(tmp_path, 1.0))
    assert line.startswith("In the longest windows of the fit, 30 s, the boat passes 0.8 lengths")
    assert short_windows(tanker(tmp_path, 45.7)) == []
