"""A mean wind and current of each run are fitted beside the numbers where they are significant."""

import re
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat_fit.fit import BoatFit
from swamp_rl.boat_fit.hypothesis import free_boat
from swamp_rl.boat_fit.identify import errors_on, fitted_boat, identify_boat, numbers_of, short_fitted
from swamp_rl.boat_fit.run_flow import RunFlow, errors_in_current, is_significant, run_flows
from swamp_rl.boat_fit.wiring import Wiring
from swamp_rl.boat_numbers.numbers import free_numbers
from swamp_rl.criticism.data.run_set import RunSet
from tests.support.hidden_boat import start_runs
from tests.support.quick_fit import fit_thrust_alone

N_R, NORTH, EAST = -0.11, 0.06, -0.08
FLOWING = f"effects: [{{effect: current, north: {NORTH}, east: {EAST}}}]\n"
WINDY = "effects: [{effect: wind, speed: 4.0, from: 2.5}]\n"
FIVE = 1  # place of the horizon of 5 s among those of the report


def sailed(folder: Path, effects: str) -> tuple[RunSet, Boat]:
    """Two runs of a hidden boat, read as runs of the start file, and this boat without its effects."""
    still = f"extends: twin.yaml\nname: still\nhull: {{n_r: {N_R}}}\n"
    (folder / "still.yaml").write_text(still)
    return start_runs(folder, still + effects, count=2), load_boat(folder / "still.yaml")


def fitted(runs: RunSet) -> tuple[BoatFit, list[str], list[RunFlow]]:
    """The fit, which weather is significant in short windows, and the currents that it has."""
    begun = Wiring(runs.boat, (), 0.0, free_boat(runs.boat, free_numbers(runs.boat)).start())
    wiring, short, significant = short_fitted(runs, begun)
    made = fitted_boat(runs, wiring, short, significant)
    return made, significant, run_flows(runs, made.hypothesis, made.fit.x, made.covariance)


def test_a_current_is_fitted_beside_the_numbers_and_bends_none(tmp_path: Path) -> None:
    runs, _ = sailed(tmp_path, FLOWING)
    made, significant, currents = fitted(runs)
    assert "current" in significant
    assert [one.name for one in currents] == list(runs.names)
    for one in currents:
        assert 0.0 < one.standard_error < 0.3 * one.speed
        assert np.hypot(one.north - NORTH, one.east - EAST) < 4.0 * one.standard_error
    (yaw,) = (one for one in numbers_of(made) if one.number.name == "hull.n_r")
    assert yaw.shown
    assert abs(yaw.value - N_R) < 4.0 * yaw.standard_error


def test_noise_is_taken_for_a_current_once_in_a_hundred_times() -> None:
    drawn = np.random.default_rng(0).normal(0.0, 0.02, (2000, 20, 2))
    every = [[RunFlow("", float(n), float(e), 0.02) for n, e in runs] for runs in drawn]
    assert 0.004 < np.mean([is_significant(runs) for runs in every]) < 0.018
    assert is_significant([*every[0], RunFlow("", 0.0, -0.1, 0.02)])
    assert not is_significant([])


def test_still_water_and_air_have_no_flow(tmp_path: Path) -> None:
    runs, _ = sailed(tmp_path, "")
    assert fitted(runs)[1:] == ([], [])


def test_a_wind_that_was_not_measured_is_fitted_beside_the_numbers(tmp_path: Path) -> None:
    runs, _ = sailed(tmp_path, WINDY)
    made, significant, _ = fitted(runs)
    assert significant == ["wind"]
    for one in run_flows(runs, made.hypothesis, made.fit.x, made.covariance, "wind"):
        away = np.hypot(one.north - 4.0 * np.cos(2.5), one.east - 4.0 * np.sin(2.5))
        assert away < 4.0 * one.standard_error < one.speed


def test_the_report_gives_the_wind_of_each_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    start_runs(tmp_path, f"extends: twin.yaml\nname: hidden\n{WINDY}", count=2)
    fit_thrust_alone(monkeypatch, tmp_path / "twin.yaml")
    found = identify_boat(tmp_path / "runs", tmp_path / "twin.yaml", tmp_path / "new.yaml")
    page = (tmp_path / "new.html").read_text(encoding="utf-8")
    assert list(found.weather) == ["wind"]
    _, rows = page.split("<h2>Wind of the runs</h2>")
    for one in found.weather["wind"]:
        assert one.speed == pytest.approx(4.0, abs=4.0 * one.standard_error)
        assert f"{one.name}</td>" in rows
    degrees = [float(angle) for angle in re.findall(r">(\d+)</td></tr>", rows)]
    assert degrees == pytest.approx([np.degrees(2.5)] * len(found.weather["wind"]), abs=10.0)


def test_a_true_boat_predicts_to_the_noise_in_the_current_of_each_run_alone(tmp_path: Path) -> None:
    runs, still = sailed(tmp_path, FLOWING)
    in_current, without = errors_in_current(runs, still)[FIVE], errors_on(runs, still)[FIVE]
    assert in_current.horizon_s == without.horizon_s == pytest.approx(5.0)
    assert in_current.position < 0.3 * without.boat_file
