"""A heading, a yaw rate or a velocity that is not of the boat's motion."""

from collections.abc import Callable

import numpy as np
import pytest

from swamp_rl.angles import turned, wrapped
from swamp_rl.boat import Boat
from swamp_rl.doctor.examine import examine
from swamp_rl.runs import Run
from tests.support.doctored import Columns, faults, gauss_markov


def noise(c: Columns, deviation: float) -> np.ndarray:
    return deviation * np.random.default_rng(8).standard_normal(len(c["time"]))


def misread_quaternion(c: Columns) -> Columns:
    """The heading of the quaternion w, x, y, z of a boat that rolls, taken for x, y, z, w."""
    w, z = np.cos(0.5 * c["heading"]), np.sin(0.5 * c["heading"])
    roll = 0.02 * np.sin(3.0 * c["time"]) + noise(c, 0.005)
    x, y = roll * w, roll * z
    return {**c, "heading": np.arctan2(2.0 * (z * y + w * x), 1.0 - 2.0 * (x**2 + y**2))}


def exchanged_velocity(c: Columns) -> Columns:
    """Surge and sway of a velocity whose north and east are exchanged."""
    north, east = turned(c["surge"], c["sway"], c["heading"])
    surge, sway = turned(east, north, -c["heading"])
    return {**c, "surge": surge, "sway": sway}


CHANGES: dict[str, tuple[Callable[[Columns], Columns], str, str]] = {
    "misread quaternion": (misread_quaternion, "heading_unrelated", "heading"),
    "sine and cosine of degrees": (
        lambda c: {**c, "heading": wrapped(np.degrees(c["heading"]))},
        "unit",
        "heading",
    ),
    "sine and cosine of degrees with noise": (
        lambda c: {**c, "heading": wrapped(np.degrees(c["heading"] + noise(c, 0.02)))},
        "heading_unrelated",
        "heading",
    ),
    "gyro of another axis": (
        lambda c: {**c, "yaw_rate": 0.3 * np.sin(3.0 * c["time"])},
        "heading_unrelated",
        "yaw_rate",
    ),
    "velocity of exchanged axes": (exchanged_velocity, "velocity_disagrees", "surge"),
}


@pytest.mark.parametrize("what", CHANGES)
def test_a_record_that_is_not_of_the_motion_is_named_with_its_column(
    what: str, sound: list[Run], twin: Boat
) -> None:
    change, code, column = CHANGES[what]
    found = faults([Run(run.name, change(dict(run.columns))) for run in sound], twin)
    assert any(finding.code == code and column in finding.columns for finding in found), found


def test_what_rests_on_a_wrong_heading_is_not_reported(sound: list[Run], twin: Boat) -> None:
    runs = [Run(run.name, misread_quaternion(dict(run.columns))) for run in sound]
    assert [one.code for one in faults(runs, twin)] == ["heading_unrelated"]


def test_without_a_yaw_rate_a_heading_that_explains_nothing_of_the_course_is_a_note(
    sound: list[Run], twin: Boat
) -> None:
    def noted(change: Callable[[Columns], Columns]) -> list[str]:
        runs = [Run(run.name, change(dict(run.columns))) for run in sound]
        kept = ("time", "north", "east", "heading", "throttle_port", "throttle_starboard")
        part = [Run(run.name, {name: run.columns[name] for name in kept}) for run in runs]
        return [str(one) for one in examine(part, twin)]

    assert noted(lambda c: c) == []
    (line,) = noted(misread_quaternion)
    assert line.startswith("note: heading_unrelated: heading: explains 0% of the variation of the course")


def test_a_velocity_is_compared_with_the_positions_in_the_axes_of_the_earth(
    sound: list[Run], twin: Boat
) -> None:
    runs = [Run(run.name, exchanged_velocity(dict(run.columns))) for run in sound]
    (found,) = faults(runs, twin)
    assert "mirror image of that of the positions: its north and east are exchanged" in found.message


def test_a_compass_that_lags_by_seconds_is_correlated_with_the_yaw_rate(sound: list[Run], twin: Boat) -> None:
    def lagging(c: Columns) -> Columns:
        heading = np.unwrap(c["heading"])
        return {**c, "heading": wrapped(np.concatenate([np.full(20, heading[0]), heading[:-20]]))}

    runs = [Run(run.name, lagging(dict(run.columns))) for run in sound]
    assert "heading_unrelated" not in [one.code for one in examine(runs, twin)]


def test_the_noise_of_a_boat_at_rest_is_not_compared(sound: list[Run], twin: Boat) -> None:
    rng = np.random.default_rng(6)

    def at_rest(c: Columns) -> Columns:
        """Positions that wander, a compass and a biased gyro with their noise."""
        places = {name: gauss_markov(rng, len(c["time"]), 0.3, 30.0) for name in ("north", "east")}
        rates = {
            "heading": 0.01 * rng.standard_normal(601),
            "yaw_rate": 0.03 + 0.01 * rng.standard_normal(601),
        }
        return {**c, **places, **rates}

    runs = [Run(run.name, at_rest(dict(run.columns))) for run in sound]
    alone = [Run(run.name, {n: v for n, v in run.columns.items() if n != "yaw_rate"}) for run in runs]
    for every in (runs, alone):
        assert "heading_unrelated" not in [one.code for one in examine(every, twin)]


@pytest.mark.parametrize("scale", [0.94, 1.06])
def test_a_surge_of_another_scale_than_the_positions_is_noted_with_the_factor(
    scale: float, sound: list[Run], twin: Boat
) -> None:
    def noted(factor: float) -> list[float]:
        runs = [Run(run.name, run.columns | {"surge": factor * run.columns["surge"]}) for run in sound]
        return [one.figures["ratio"] for one in examine(runs, twin) if one.code == "surge_scale"]

    assert noted(1.0) == []
    assert noted(scale) == [pytest.approx(scale, abs=0.01)]
