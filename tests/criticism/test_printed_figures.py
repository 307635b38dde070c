"""Criticism of printed figures: predictions by closed forms, hidden effects named, bad files refused."""

import html
import json
import math
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from scipy.stats import multivariate_normal
from swamp_rl.experiments.config.posterior import write_posterior

from swamp_rl.boat import Boat, load_boat
from swamp_rl.boat.load import boat_chain
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.errors import UserError
from swamp_rl.files import find_config, read_yaml, write_yaml
from swamp_rl.json_text import schema_text
from swamp_rl.physics.resistance import SPEED
from swamp_rl.printed_figures.diagnose import diagnose_figures
from swamp_rl.printed_figures.predict import fleet_of, misfits, predicted
from swamp_rl.printed_figures.result import TITLE, FiguresDiagnosis
from swamp_rl.printed_figures.schema import Figure, read_figures
from swamp_rl.printed_figures.select import laplace_term
from swamp_rl.simulator import tank
from swamp_rl.simulator.state import SURGE, SWAY, YAW_RATE
from tests.support.boats import commands, track
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture

Entry = dict[str, Any]
THESIS = load_boat("swamp-thesis")
SHIPPED = find_config("trials", "thesis_figures")
NOTHING = np.zeros(0)
BOLLARD, NOZZLE, TANK_WATER = 12.2, 9e-4, 1001.0  # N, m2, kg/m3


def entry(manoeuvre: str, figure: str, value: float, error: float, **keys: Any) -> Entry:
    given = {"group": "all", "manoeuvre": manoeuvre, "mass": 58.0, "figure": figure, "source": "made up"}
    return given | {"value": value, "error": error} | keys


def written(path: Path, *figures: Entry, **keys: Any) -> Path:
    write_yaml(path, {"name": "made_up", "fit": [["all"]], **keys, "figures": list(figures)})
    return path


def made(path: Path, *figures: Entry, boat: str = "swamp-thesis") -> list[float]:
    """What the boat file makes of the figures."""
    found = read_figures(written(path, *figures), load_boat(boat))
    return predicted(fleet_of(boat_chain(boat), found), found.figures, Hypothesis(), NOTHING).tolist()


def circle(boat: Boat, angle: float) -> tuple[float, float]:
    """Diameter [m] and speed [m/s] of the steady circle at 60 %, by a run of its own."""
    last = track(boat, commands(angle, -angle, (0.6,) * 4, 1500))[-200:]
    speed = float(np.hypot(last[:, SURGE], last[:, SWAY]).mean())
    return 2.0 * speed / abs(float(last[:, YAW_RATE].mean())), speed


def with_effects(folder: Path, *effects: Entry, extends: str = "swamp-thesis") -> Boat:
    path = folder / f"{extends}-changed.yaml"
    write_yaml(path, {"extends": extends, "effects": list(effects)})
    return load_boat(path)


def circles_of(boat: Boat, *angles: float) -> list[Entry]:
    found = []
    for angle in angles:
        for name, value in zip(("steady_diameter", "steady_speed"), circle(boat, angle), strict=True):
            keys = {"angle_deg": angle, "throttle": 0.6}
            found.append(entry("turning-circle", name, value, 0.01 * value, **keys))
    return found


def law_figures(factor: float, loss: float) -> list[Entry]:
    """Bollard pull and towed 1 - t of jets with T = factor T_bollard (1 - loss V_a / V_o)."""
    found = []
    for throttle in (0.3, 0.6, 1.0):
        value = factor * 4.0 * BOLLARD * throttle**2
        found.append(entry("bollard", "pull", value, 0.02 * value, throttle=throttle))
    for throttle in (0.5, 0.7, 0.9):
        jet = math.sqrt(factor * BOLLARD * throttle**2 / (TANK_WATER * NOZZLE))
        value = factor * (1.0 - loss / jet)
        keys = {"throttle": throttle, "thrusters": ["bs", "bp"], "speed": 1.0, "water_density": TANK_WATER}
        found.append(entry("towed", "one_minus_t", value, 0.01, **keys))
    return found


def test_a_boat_on_a_line_and_on_a_carriage_gives_the_closed_forms(tmp_path: Path) -> None:
    effects = [
        {"effect": "thrust_deduction", "low": 0.9, "high": 0.9},
        {"effect": "advance_thrust_loss", "factor": 0.7},
    ]
    boat = with_effects(tmp_path, *effects)
    figures = law_figures(0.9, 0.7)
    path = str(tmp_path / "swamp-thesis-changed.yaml")
    assert boat.mass == 58.0
    values = made(tmp_path / "figures.yaml", *figures, boat=path)
    assert values == pytest.approx([one["value"] for one in figures], rel=1e-6)


def test_the_towed_resistance_is_the_towing_tank_s_own(tmp_path: Path) -> None:
    speed = 0.99  # of table 4.7, deep
    assert speed in tank(THESIS)[0, SPEED]
    towed = entry("towed", "resistance", 9.68, 0.1, speed=speed, water_density=TANK_WATER)
    assert made(tmp_path / "figures.yaml", towed) == pytest.approx([9.68], rel=1e-6)


def test_a_circle_is_that_of_an_open_loop_run_at_the_load_of_the_figure(tmp_path: Path) -> None:
    light = {"mass": 48.0, "draught": 0.115}
    figures = [one | {"mass": 48.0} for one in circles_of(THESIS, 30.0)]
    found = read_figures(written(tmp_path / "f.yaml", *figures, loads=[light | {"source": "x"}]), THESIS)
    values = predicted(fleet_of(boat_chain("swamp-thesis"), found), found.figures, Hypothesis(), NOTHING)
    write_yaml(tmp_path / "light.yaml", {"extends": "swamp-thesis", **light})
    assert values == pytest.approx(circle(load_boat(tmp_path / "light.yaml"), 30.0), rel=1e-3)


def test_the_boat_file_is_read_once_for_all_loads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    light = {"mass": 48.0, "draught": 0.115, "source": "x"}
    figures = [entry("towed", "resistance", 9.68, 0.1, speed=0.99, mass=mass) for mass in (48.0, 58.0)]
    path, boat = written(tmp_path / "f.yaml", *figures, loads=[light]), tmp_path / "boat.yaml"
    write_yaml(boat, {"extends": "swamp-thesis"})
    read: list[Path] = []
    monkeypatch.setattr("swamp_rl.boat.load.read_yaml", lambda file: (read.append(file), read_yaml(file))[1])
    with pytest.raises(UserError, match="--fit"):
        diagnose_figures(path, str(boat), tmp_path / "out", [["no such group"]])
    assert read.count(boat) == 1


@pytest.mark.parametrize("boat", ["swamp-thesis", "swamp-light"])
def test_the_growth_rate_is_that_of_a_small_yaw_rate_in_straight_running(boat: str, tmp_path: Path) -> None:
    loaded = load_boat(boat)
    keys = {"throttle": 0.6, "mass": loaded.mass}
    (rate,) = made(tmp_path / "f.yaml", entry("straight", "yaw_growth_rate", 0.0, 0.01, **keys), boat=boat)
    ahead = commands(0.0, 0.0, (0.6,) * 4, 800)
    start = track(loaded, ahead)[-1:].copy()
    start[0, YAW_RATE] = 1e-7
    later = np.abs(track(loaded, ahead[:300], start=start)[[100, 300], YAW_RATE])
    assert math.log(later[1] / later[0]) / 20.0 == pytest.approx(rate, abs=0.002)


def test_a_limit_is_missed_beyond_it_only() -> None:
    given = entry("bollard", "pull", 2.0, 0.5, throttle=1.0)
    most, least, plain = (
        Figure.model_validate(given | limit)
        for limit in ({"limit": "at_most"}, {"limit": "at_least"}, dict[str, str]())
    )
    assert misfits([most, least, plain], np.array([1.0, 1.0, 1.0])).tolist() == [0.0, -2.0, -2.0]
    assert misfits([most, least, plain], np.array([3.0, 3.0, 3.0])).tolist() == [2.0, 0.0, 2.0]
    assert misfits([plain], np.array([math.nan]))[0] >= 1e3


def test_the_marginal_likelihood_of_a_linear_model_is_exact() -> None:
    rng = np.random.default_rng(3)
    slopes, deviation = rng.normal(size=(6, 2)), np.array([0.7, 2.0])
    measured = rng.normal(size=6)
    precision = np.diag(deviation**-2)
    information = slopes.T @ slopes + precision
    x = np.linalg.solve(information, slopes.T @ measured)
    least = float(((measured - slopes @ x) ** 2).sum() + x @ precision @ x)
    covariance = np.eye(6) + slopes @ np.diag(deviation**2) @ slopes.T
    exact = -2.0 * multivariate_normal(cov=covariance).logpdf(measured) - 6.0 * math.log(2.0 * math.pi)
    assert least + laplace_term(information, deviation, np.ones(2)) == pytest.approx(exact)


def test_a_hidden_thrust_law_is_named_from_the_bollard_and_towed_figures(tmp_path: Path) -> None:
    path = written(tmp_path / "law.yaml", *law_figures(0.95, 0.6))
    found = diagnose_figures(path, "swamp-thesis", tmp_path / "out")
    assert found.verdict == "cause"
    numbers = {cause.effect: cause.parameters for cause in found.causes}
    assert set(numbers) == {"advance_thrust_loss", "thrust_deduction"}
    truth = {("advance_thrust_loss", "factor"): 0.6, ("thrust_deduction", "low"): 0.95}
    for (effect, name), value in truth.items():
        estimate = numbers[effect][name]
        assert estimate.value == pytest.approx(value, abs=0.02)
        assert 0.0 < estimate.standard_error < 0.1
    extended = load_boat(tmp_path / "out" / "extended_boat.yaml")
    assert [one.effect.name for one in extended.effects] == ["advance_thrust_loss", "thrust_deduction"]
    assert found.gain[0].chi2_after < 1.0 < 100.0 < found.gain[0].chi2_before
    assert "demihull_spacing" in found.stages[0].unseen


HIDDEN = {
    "demihull_spacing": ("spacing", 0.7),
    "sway_drag": ("scale", 1.5),
    "yaw_damping": ("scale", 1.4),
}


@pytest.mark.parametrize("effect", HIDDEN)
def test_the_effect_that_made_the_circles_is_named(effect: str, tmp_path: Path) -> None:
    name, value = HIDDEN[effect]
    boat = with_effects(tmp_path, {"effect": effect, name: value})
    path = written(tmp_path / "circles.yaml", *circles_of(boat, 20.0, 40.0, 60.0))
    found = diagnose_figures(path, "swamp-thesis", tmp_path / "out")
    assert [cause.effect for cause in found.causes] == [effect]
    assert found.verdict == "cause" and found.causes[0].parameters[name].value == pytest.approx(
        value, rel=0.05
    )


def test_effects_that_the_figures_do_not_separate_are_both_named(tmp_path: Path) -> None:
    boat = with_effects(tmp_path, {"effect": "thrust_scale", "scale": 1.3})
    path = written(tmp_path / "circles.yaml", *circles_of(boat, 20.0, 60.0))  # at one throttle
    found = diagnose_figures(path, "swamp-thesis", tmp_path / "out")
    assert found.verdict == "indistinguishable"
    assert {"thrust_scale", "thrust_deduction"} <= set(found.indistinguishable[0])


def test_figures_of_the_boat_file_itself_name_nothing(tmp_path: Path) -> None:
    path = written(tmp_path / "circles.yaml", *circles_of(THESIS, 20.0, 60.0))
    found = diagnose_figures(path, "swamp-thesis", tmp_path / "out")
    assert found.verdict == "nothing_wrong" and not found.causes
    assert load_boat(tmp_path / "out" / "extended_boat.yaml").effects == ()


@pytest.fixture(scope="module")
def shipped(tmp_path_factory: pytest.TempPathFactory) -> tuple[FiguresDiagnosis, Path]:
    out = tmp_path_factory.mktemp("shipped") / "out"
    diagnose_figures(SHIPPED, "swamp-thesis", out)
    return FiguresDiagnosis.model_validate_json((out / "diagnosis.json").read_text()), out


@pytest.mark.slow
def test_the_thesis_s_own_figures_name_the_thrust_law_and_the_demihulls(
    shipped: tuple[FiguresDiagnosis, Path],
) -> None:
    found, out = shipped
    assert found.verdict == "cause"
    assert [set(stage.named) for stage in found.stages] == [
        {"advance_thrust_loss", "thrust_deduction"},
        {"demihull_spacing"},
    ]
    (spacing,) = (one.parameters["spacing"] for one in found.causes if one.effect == "demihull_spacing")
    assert abs(spacing.value - 0.80) < 2.0 * spacing.standard_error
    assert len(load_boat(out / "extended_boat.yaml").effects) == 3


@pytest.mark.slow
def test_the_extended_boat_predicts_the_held_out_circle(
    shipped: tuple[FiguresDiagnosis, Path],
) -> None:
    found, out = shipped
    gain = {one.group: one for one in found.gain}
    assert gain["circle-60"].use == "judged"
    assert gain["circle-60"].chi2_after < 2.0 < 20.0 < gain["circle-60"].chi2_before
    assert gain["stability"].chi2_after < 4.0 < 100.0 < gain["stability"].chi2_before
    page = (out / "report.html").read_text()
    for row in found.figures:
        assert html.escape(row.reading) in page
    assert {row.use for row in found.figures} == {"fitted", "judged", "alternative"}


@pytest.mark.slow
def test_with_the_circles_exchanged_the_report_says_what_that_one_can_show(
    shipped: tuple[FiguresDiagnosis, Path],
) -> None:
    (turned,) = shipped[0].exchange
    assert (turned.fitted, turned.judged) == ("circle-60", "circle-30")
    assert turned.named == []  # the thrust law alone meets it
    assert turned.chi2_after > 20.0


@pytest.mark.slow
def test_the_posterior_of_the_figures_is_a_level_of_disturbance(
    shipped: tuple[FiguresDiagnosis, Path], tmp_path: Path
) -> None:
    level = write_posterior(shipped[1] / "diagnosis.json", tmp_path / "level.yaml")
    assert {one["effect"] for one in level["effects"]} == {cause.effect for cause in shipped[0].causes}


@pytest.mark.slow
def test_the_answer_fits_its_published_schema(shipped: tuple[FiguresDiagnosis, Path]) -> None:
    published = Path(__file__).parents[2] / "docs" / "figures_diagnosis.schema.json"
    assert published.read_text(encoding="utf-8") == schema_text(FiguresDiagnosis, TITLE)
    answer = json.loads((shipped[1] / "diagnosis.json").read_text())
    jsonschema.validate(answer, json.loads(published.read_text(encoding="utf-8")))


GOOD = entry("bollard", "pull", 17.6, 0.9, throttle=0.6)
FAULTY: dict[str, tuple[Entry, str]] = {
    "unknown manoeuvre": (GOOD | {"manoeuvre": "bolard"}, "did you mean 'bollard'"),
    "unknown figure": (GOOD | {"figure": "push"}, "no such figure"),
    "missing error": ({k: v for k, v in GOOD.items() if k != "error"}, "error: is missing; add it"),
    "an error of nothing": (GOOD | {"error": 0.0}, "error: must be at least 1e-09, not 0.0"),
    "no number": (GOOD | {"value": math.nan}, "value: must be a finite number"),
    "given twice": (GOOD | {"value": 18.0}, "the same figure of the same test as figures 1"),
    "unknown mass": (GOOD | {"mass": 50.0}, "mass 50 kg is neither"),
    "unknown thruster": (GOOD | {"thrusters": ["bow"]}, "'bow' is not a thruster"),
    "another manoeuvre's key": (GOOD | {"angle_deg": 3.0}, "angle_deg: bollard has no such key"),
    "a command that lacks": (GOOD | {"manoeuvre": "towed", "figure": "resistance"}, "speed is missing"),
    "unknown key": (GOOD | {"sourc": "x"}, "sourc: unknown key; did you mean 'source'"),
}


@pytest.mark.parametrize("fault", FAULTY)
def test_a_faulty_figure_is_one_line_with_file_and_entry(fault: str, tmp_path: Path, call: Call) -> None:
    figure, result = FAULTY[fault]
    path = written(tmp_path / "figures.yaml", GOOD, figure)
    done = call("diagnose", path, "--boat", "swamp-thesis", "--out", tmp_path / "out")
    assert_complains(done, str(path), "figures 2", result, code=2)
    assert not (tmp_path / "out").exists()


def test_a_boat_file_in_the_place_of_figures_is_distinguished(tmp_path: Path, call: Call) -> None:
    write_yaml(tmp_path / "mine.yaml", {"extends": "swamp"})
    words = "diagnose", tmp_path / "mine.yaml", "--out", tmp_path / "out"
    message = "mine.yaml: holds no printed figures; name a folder of runs"
    assert_complains(call(*words, "--boat", "swamp"), message)
    assert_complains(call(*words), "mine.yaml: is read as printed figures, whose boat is needed: --boat NAME")


def test_every_fault_of_a_file_has_a_line(tmp_path: Path, call: Call) -> None:
    figures = [GOOD, *(figure for figure, _ in FAULTY.values())]
    particular = {"effect": "waves", "parameter": "height", "value": 0.0, "error": 1.0, "source": "x"}
    path = written(tmp_path / "figures.yaml", *figures, particulars=[particular], fit=[["all"], ["al"]])
    done = call("diagnose", path, "--boat", "swamp-thesis", "--out", tmp_path / "out")
    lines = done[2].splitlines()
    assert (
        done[0] == 2
        and len(lines) > len(FAULTY)
        and all(line.startswith(f"swamp-rl: {path}: ") for line in lines)
    )
    assert all(any(result in line for line in lines) for _, result in FAULTY.values())
    assert any("waves has no such parameter" in line for line in lines)


def test_groups_to_fit_are_those_of_the_file(tmp_path: Path, call: Call) -> None:
    path = written(tmp_path / "figures.yaml", GOOD)
    done = call("diagnose", path, "--boat", "swamp-thesis", "--out", tmp_path / "out", "--fit", "al")
    assert_complains(done, "--fit", "'al'", "did you mean 'all'", code=2)


def test_the_shipped_file_names_a_source_for_every_figure() -> None:
    given = read_yaml(SHIPPED)
    assert len(given["figures"]) >= 25
    assert all("thesis" in one["source"] or "002" in one["source"] for one in given["figures"])
    assert json.dumps(given["fit"]) == '[["bollard", "tank"], ["circle-30"]]'
