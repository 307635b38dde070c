"""Curves of path files: their geometry against what is known of circles and lines."""

import math
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.guidance.curve import Curve, progress
from swamp_rl.guidance.path_file import MOST_PLACES, PathFile, load_path


def curve(*pieces: dict[str, object], **keys: object) -> Curve:
    return PathFile.model_validate({"name": "p", "speed": 1.0, "pieces": list(pieces)} | keys).curve()


def test_an_eight_is_two_circles_that_begin_and_end_at_one_place() -> None:
    eight = curve({"kind": "eight", "radius": 3.0})
    assert eight.length == pytest.approx(4.0 * math.pi * 3.0, rel=1e-3)
    assert eight.places[-1] == pytest.approx(eight.places[0], abs=1e-9)
    assert eight.places[:, 1].min() == pytest.approx(-6.0, rel=1e-3)
    assert eight.places[:, 1].max() == pytest.approx(6.0, rel=1e-3)
    assert set(np.round(eight.curvature, 12)) == {round(1 / 3.0, 12), round(-1 / 3.0, 12)}


def test_an_arc_to_starboard_from_north_turns_east() -> None:
    arc = curve({"kind": "arc", "radius": 2.0, "turn_deg": 90.0})
    assert arc.places[-1] == pytest.approx([2.0, 2.0])
    assert arc.course[-1] == pytest.approx(math.pi / 2.0)


def test_lawn_mower_lines_lie_their_spacing_apart() -> None:
    mower = curve({"kind": "lawn_mower", "length": 20.0, "spacing": 4.0, "lines": 3, "side": "port"})
    assert mower.length == pytest.approx(3 * 20.0 + 2 * math.pi * 2.0, rel=1e-3)
    assert mower.places[-1] == pytest.approx([20.0, -8.0], abs=1e-9)


def test_a_spline_through_places_of_a_circle_has_its_curvature() -> None:
    angles = np.linspace(0.0, 1.5 * math.pi, 13)
    places = [[10.0 * math.sin(a), 10.0 - 10.0 * math.cos(a)] for a in angles[1:]]
    bend = curve({"kind": "spline", "through": places}).curvature
    inner = bend[len(bend) // 3 : -len(bend) // 3]
    assert inner == pytest.approx(np.full(len(inner), 0.1), rel=0.02)


def test_the_error_is_positive_to_starboard_and_the_branch_is_that_of_the_progress() -> None:
    eight = curve({"kind": "eight", "radius": 5.0})
    angle = np.linspace(0.0, 2.0 * math.pi, 200)
    inside = [[4.0 * math.sin(a), 5.0 - 4.0 * math.cos(a)] for a in angle]
    inside += [[6.0 * math.sin(a), -5.0 + 6.0 * math.cos(a)] for a in angle]
    found = progress(eight, np.array(inside), 3.0)
    assert found[2:198, 1] == pytest.approx(np.full(196, 1.0), abs=2e-3)
    assert found[210:-2, 1] == pytest.approx(np.full(188, 1.0), abs=2e-3)
    assert found[-1, 0] == pytest.approx(eight.length, rel=1e-2)


def test_the_way_past_the_end_of_a_curve_is_no_error() -> None:
    line = curve({"kind": "line", "to": [10.0, 0.0]})
    track = np.array([[9.0, 0.1], [9.9, 0.1], [10.4, 0.1], [10.8, -0.2]])
    assert progress(line, track, 10.0) == pytest.approx(
        np.array([[9.0, 0.1], [9.9, 0.1], [10.0, 0.1], [10.0, -0.2]])
    )


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ("pieces: []", "pieces"),
        ("pieces: [{kind: arc, radius: 0.0, turn_deg: 90.0}]", "radius"),
        ("pieces: [{kind: arc, radius: 2.0, turn_deg: 0.0}]", "at least a degree"),
        ("pieces: [{kind: line, to: [0.0, 0.0]}]", "begins within 0.1 m"),
        ("pieces: [{kind: spline, through: [[1.0, 1.0], [1.0, 1.0]]}]", "drop one"),
        ("pieces: [{kind: line, to: [900000.0, 0.0]}]", "more than a day"),
        ("pieces: [{kind: lin, to: [1.0, 0.0]}]", "kind"),
    ],
)
def test_what_is_no_path_is_refused_by_its_key(tmp_path: Path, keys: str, message: str) -> None:
    file = tmp_path / "p.yaml"
    file.write_text(f"name: p\nspeed: 1.0\n{keys}\n")
    with pytest.raises(UserError, match=r"p\.yaml") as refused:
        load_path(file)
    assert message in str(refused.value)


def test_a_few_words_do_not_make_a_curve_of_millions_of_places() -> None:
    lines = {"kind": "lawn_mower", "length": 0.1, "spacing": 0.1, "lines": 1000}
    with pytest.raises(ValueError, match=rf"pieces\.2: the curve has more than {MOST_PLACES} places"):
        curve(*([lines] * 1000), speed=50.0)
