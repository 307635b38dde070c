"""Captive trials: the tank's figures, closed forms, what holds by symmetry, and bad input in one line."""

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from swamp_rl.experiments.cli import app as cli

from swamp_rl.boat import Boat, Thruster, load_boat
from swamp_rl.boat.thrust_deduction import ThrustDeduction
from swamp_rl.effects import parse_effects
from swamp_rl.errors import UserError
from swamp_rl.identification.deduction import deduction_points
from swamp_rl.identification.motion import motion_of
from swamp_rl.identification.simulated import record_run, straights
from swamp_rl.manoeuvres.captive import captive_point, captive_trial, self_propulsion, thruster_sets
from tests.support.boats import commands, track
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture

SWAMP, THESIS, ESSO = load_boat("swamp"), load_boat("swamp-thesis"), load_boat("esso_osaka")
ALL = SWAMP.thruster_names
FULL = 12.2  # N of one jet at rest (thesis Table 5.5)


def boat_with(deduction: tuple[float, float], advance_loss: float = 0.0, base: Boat = THESIS) -> Boat:
    """The boat with 1 - t at 30 and at 100 % of the throttle, and loss of thrust with advance."""
    low, high = deduction
    part = ThrustDeduction(throttle_low=0.3, factor_low=low, throttle_high=1.0, factor_high=high)
    loss = [{"effect": "advance_thrust_loss", "factor": advance_loss}]
    effects = tuple(parse_effects(loss, "test", base.thruster_names))
    return base.model_copy(update={"thrust_deduction": part, "effects": effects})


def twin_fixed() -> Boat:
    """SWAMP's hull with two fixed thrusters that give 20 N ahead and 8 N astern."""
    common = {"kind": "fixed", "x": -0.5, "azimuth_min": 0.0, "azimuth_max": 0.0, "azimuth_rate": 1.0}
    curve = {"pump_time_constant": 0.3, "thrust_linear": 0.0, "thrust_quadratic": 20.0, "astern_linear": 8.0}
    given = tuple(Thruster(name=name, y=y, **common, **curve) for name, y in (("port", -0.3), ("star", 0.3)))
    even = ThrustDeduction(throttle_low=0.0, factor_low=1.0, throttle_high=1.0, factor_high=1.0)
    joypad = SWAMP.joypad.model_copy(update={"thrusters": ("port", "star")})
    return SWAMP.model_copy(update={"thrusters": given, "thrust_deduction": even, "joypad": joypad})


@pytest.mark.parametrize(("throttle", "pull"), [(0.6, 17.6), (1.0, 48.8)])
def test_four_jets_pull_on_the_bollard_what_the_towing_tank_measured(throttle: float, pull: float) -> None:
    assert captive_point(SWAMP, 0.0, throttle, ALL).thrust == pytest.approx(pull, rel=0.05)


@pytest.mark.parametrize("names", [("bs", "bp"), ("ss", "sp")])
def test_two_jets_at_70_percent_and_1_m_s_have_the_tanks_thrust_factor(names: tuple[str, ...]) -> None:
    assert captive_point(SWAMP, 1.0, 0.7, names).thrust_factor == pytest.approx(0.68, abs=0.03)


def test_the_pull_is_the_sum_of_the_jets_thrust_times_the_deduction() -> None:
    """Deduction linear in the throttle from 0.30 at 30 % to 0.75 at 100 %."""
    boat = boat_with((0.30, 0.75))
    for count, names in enumerate(thruster_sets(boat), start=1):
        for throttle in (0.2, 0.6, 1.0):
            factor = 0.30 + 0.45 * max(throttle - 0.3, 0.0) / 0.7
            point = captive_point(boat, 0.0, throttle, names)
            assert point.bollard_thrust == pytest.approx(count * FULL * throttle**2)
            assert point.thrust == pytest.approx(count * FULL * throttle**2 * factor)
            assert point.thrust_factor == pytest.approx(factor)


def test_under_way_the_thrust_falls_by_the_speed_over_the_jets() -> None:
    """T = T_b (1 - c V / V_o) with V_o = sqrt(T_b / (rho A)) of one jet (thesis eq. 5.2)."""
    for speed, throttle in ((0.5, 0.6), (1.0, 0.7), (1.4, 1.0)):
        one = FULL * throttle**2
        factor = 1.0 - 0.86 * speed * math.sqrt(1025.0 * 9e-4 / one)
        assert captive_point(SWAMP, speed, throttle, ALL).thrust_factor == pytest.approx(factor)


def test_with_the_jets_stopped_the_carriage_tows_with_the_resistance_of_the_tank() -> None:
    point = captive_point(SWAMP, 0.99, 0.0, ALL)
    assert point.towing_force == pytest.approx(9.68 * 1025 / 1001)
    assert point.towing_force == pytest.approx(point.resistance)
    assert math.isnan(point.thrust_factor)


def test_port_and_starboard_jets_pull_alike_and_turn_the_boat_opposite_ways() -> None:
    for speed in (0.0, 0.8):
        starboard, port = (captive_point(SWAMP, speed, 0.8, names) for names in (("bs", "ss"), ("bp", "sp")))
        assert port.towing_force == pytest.approx(starboard.towing_force)
        assert port.yaw_moment == pytest.approx(-starboard.yaw_moment)
        assert starboard.yaw_moment == pytest.approx(-0.4 * starboard.thrust)


def test_the_double_ended_boat_pushes_astern_as_ahead_and_a_propeller_does_not() -> None:
    ahead, astern = (captive_point(SWAMP, 0.9, 0.7, ALL, astern) for astern in (False, True))
    assert astern[2:6] == pytest.approx(ahead[2:6])
    assert captive_point(ESSO, 0.0, 0.7, ("main",), astern=True).thrust < 0.5 * (
        captive_point(ESSO, 0.0, 0.7, ("main",)).thrust
    )


def test_a_propeller_pulls_by_its_thrust_coefficient_at_rest_less_its_deduction() -> None:
    """(1 - t_P) rho D^4 K_T(0) n^2 with the published table of the model ship."""
    thrust = 998.0 * 0.084**4 * 0.3278 * (0.8 * 16.67) ** 2
    point = captive_point(ESSO, 0.0, 0.8, ("main",))
    assert point.bollard_thrust == pytest.approx(thrust)
    assert point.thrust == pytest.approx((1.0 - 0.22) * thrust)


def test_fixed_thrusters_pull_ahead_and_astern_by_their_own_curves() -> None:
    boat = twin_fixed()
    assert captive_point(boat, 0.0, 0.5, ("port", "star")).thrust == pytest.approx(2 * 20.0 * 0.25)
    assert captive_point(boat, 0.0, 0.5, ("port", "star"), astern=True).thrust == pytest.approx(2 * 8.0 * 0.5)
    alone = captive_point(boat, 0.0, 0.5, ("port",))
    assert (alone.thrust, alone.yaw_moment) == pytest.approx((5.0, 1.5))


def test_the_boat_runs_free_at_the_speed_of_its_self_propulsion_point() -> None:
    throttle = self_propulsion(SWAMP, 1.0, ALL)
    assert captive_point(SWAMP, 1.0, throttle, ALL).towing_force == pytest.approx(0.0, abs=1e-3)
    sailed = track(SWAMP, commands(0.0, 0.0, (throttle,) * 4, 1500), velocity=(0.9, 0.0, 0.0))
    assert sailed[-1, 3] == pytest.approx(1.0, abs=1e-3)
    assert math.isnan(self_propulsion(SWAMP, 1.0, ("bs",)))


def test_a_free_running_boat_and_a_towed_one_show_the_same_thrust_factor() -> None:
    """Eq. 7.3 at the speed that a throttle reaches is eq. 7.1 without a towing force."""
    rows = straights(SWAMP, 0.1, (0.6, 0.9), True)
    run = record_run(SWAMP, rows, 0.1, np.zeros(6), np.random.default_rng(0))
    found = deduction_points(motion_of(run, SWAMP), SWAMP)
    assert len(found) == 2
    for point in found:
        towed = captive_point(SWAMP, point.speed, point.throttle, ALL)
        assert point.factor == pytest.approx(towed.thrust_factor, abs=0.01)


def test_a_trial_runs_every_set_speed_and_throttle_in_order() -> None:
    points = captive_trial(SWAMP, [0.5, 1.0], [0.0, 0.6], thruster_sets(SWAMP, ["2", "ss,sp"]))
    assert [(p.thrusters, p.speed, p.throttle) for p in points] == [
        (names, speed, throttle)
        for names in (("bs", "bp"), ("ss", "sp"))
        for speed in (0.5, 1.0)
        for throttle in (0.0, 0.6)
    ]


def test_the_bollard_verb_writes_data_figures_and_a_picture(call: Call) -> None:
    code, out, error = call("trial", "bollard", "--boat", "swamp", "--out", "b")
    assert (code, error) == (0, "")
    assert "bs, bp, ss, sp: pull in N at 10 %" in out
    with Path("b/captive.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4 * 10
    found = json.loads(Path("b/analysis/analysis.json").read_text())
    last = captive_point(SWAMP, 0.0, 1.0, ALL)
    assert found["points"][-1]["thrust"] == last.thrust == float(rows[-1]["thrust"])
    assert "| bs, bp, ss, sp | 100 |" in Path("b/analysis/report.md").read_text()
    assert Path("b/analysis/bollard_pull.png").read_bytes().startswith(b"\x89PNG")


def test_the_towed_verb_reports_eq_7_1_and_the_self_propulsion_point(call: Call) -> None:
    words = ["--speed", "1", "--throttle", "0.7", "--throttle", "0", "--jets", "bs,bp", "--out", "t"]
    code, out, error = call("trial", "towed", *words)
    assert (code, error) == (0, "")
    point = captive_point(SWAMP, 1.0, 0.7, ("bs", "bp"))
    assert f"bs, bp at 1 m/s: 1 - t at 70 % {point.thrust_factor:.3f}, 0 % –" in out
    found = json.loads(Path("t/analysis/analysis.json").read_text())
    assert found["points"][0]["thrust_factor"] == point.thrust_factor
    assert found["points"][1]["thrust_factor"] is None
    assert found["self_propulsion"][0]["throttle"] == pytest.approx(self_propulsion(SWAMP, 1.0, ("bs", "bp")))
    assert Path("t/analysis/towed.png").read_bytes().startswith(b"\x89PNG")
    assert call("trial", "towed", *words)[0] == 0  # an earlier result is replaced


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (["bollard"], ["Missing option '--out'"]),
        (["bollard", "--out", "b", "--throttle", "1.2"], ["throttle 1.2", "from 0 to 1"]),
        (["bollard", "--out", "b", "--throttle", "nan"], ["throttle nan", "from 0 to 1"]),
        (["bollard", "--out", "b", "--throttle", "0.5", "--throttle", "0.5"], ["throttle 0.5", "twice"]),
        (["bollard", "--out", "b", "--jets", "bs,xx"], ["'xx'", "bs, bp, ss, sp"]),
        (["bollard", "--out", "b", "--jets", "bs,bp,bs"], ["bs", "twice"]),
        (["bollard", "--out", "b", "--jets", "bs,bp", "--jets", "bp,bs"], ["bs,bp", "twice"]),
        (["bollard", "--out", "b", "--jets", "5"], ["jets 5", "1 to 4"]),
        (["bollard", "--out", "b", "--boat", "nowhere"], ["nowhere"]),
        (["towed", "--out", "b"], ["Missing option '--speed'"]),
        (["towed", "--out", "b", "--speed", "3"], ["speed 3", "1.74 m/s"]),
        (["towed", "--out", "b", "--speed", "-1"], ["speed -1", "from 0"]),
        (["towed", "--out", "b", "--speed", "1", "--speed", "1.0"], ["speed 1", "twice"]),
    ],
)
def test_wrong_arguments_are_one_line_and_leave_nothing(
    call: Call, words: list[str], parts: list[str]
) -> None:
    assert_complains(call("trial", *words), *parts, code=cli.BAD_INPUT)
    assert list(Path().iterdir()) == []


def test_thrusters_that_cannot_push_astern_are_named() -> None:
    thrusters = tuple(one.model_copy(update={"azimuth_max": 1.0}) for one in SWAMP.thrusters)
    boat = SWAMP.model_copy(update={"thrusters": thrusters})
    with pytest.raises(UserError, match="bs cannot push astern"):
        captive_trial(boat, [0.0], [0.5], [("bs",)], astern=True)


def test_what_is_no_captive_trial_is_never_replaced(call: Call) -> None:
    Path("b").mkdir()
    Path("b/letter.txt").write_text("dear reader")
    assert_complains(call("trial", "bollard", "--out", "b"), "already exists")
    assert [path.name for path in Path("b").iterdir()] == ["letter.txt"]
