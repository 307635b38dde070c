"""The Esso Osaka model ship: propeller and rudder against their formulas, motion against pond tests."""

import csv
import math
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from swamp_rl.envs.task import Task
from swamp_rl.envs.world import world_of

from swamp_rl.boat import PropellerRudder, load_boat
from swamp_rl.errors import UserError
from swamp_rl.physics.propulsion import propeller_with_rudder
from swamp_rl.physics.rudder import inflow_across
from swamp_rl.runs import Run
from swamp_rl.runs.free_running import import_free_running
from swamp_rl.simulator import initial_state, parameters, step, tank
from swamp_rl.simulator.replay import replay
from swamp_rl.simulator.state import ACTUATORS, EAST, HEADING, SURGE
from tests.support.boats import Array

DATA = Path(__file__).parents[3] / "shared" / "data" / "esso_osaka"
BOAT = load_boat("esso_osaka")
P = parameters(BOAT)[0]
on_the_pond = pytest.mark.skipif(not DATA.is_dir(), reason="the pond data are not beside this checkout")


def main() -> PropellerRudder:
    (actuator,) = BOAT.thrusters
    assert isinstance(actuator, PropellerRudder)
    return actuator


def sailed(
    rudder: float, revolutions: float, seconds: float, speed: float = 0.0, boats: int = 1, **fields: float
) -> Array:
    """(T + 1, S) states of the first of some equal boats under a held command, degrees and rps."""
    params = parameters(BOAT, boats)
    for name, value in fields.items():
        params[name] = value
    state = initial_state(params, np.zeros((boats, 3)), np.tile([speed, 0.0, 0.0], (boats, 1)))
    command = np.tile([math.radians(rudder), revolutions], (boats, 1))
    track = [state[0].copy()]
    for _ in range(round(seconds / 0.1)):
        step(state, params, tank(BOAT), command, np.zeros(boats, np.uint64), 0.1, 2)
        track.append(state[0].copy())
    return np.array(track)


def test_the_drift_at_the_rudder_adds_its_share_to_the_flow_straightening() -> None:
    plain, steep = P.copy(), P.copy()
    steep["rudder_drift_slope"] = 0.8
    u, v, r = 0.3, -0.05, 0.02
    across = v + main().rudder.flow_lever * BOAT.length * r
    drift = math.atan2(abs(across), u)
    both = [inflow_across(u, v, r, 0, p) for p in (plain, steep)]
    assert both[1] / both[0] == pytest.approx(1.0 + 0.8 * drift)


@pytest.mark.parametrize("n", [8.0, -8.0])
def test_a_side_force_of_the_propeller_is_a_share_of_its_thrust_and_acts_where_it_is(n: float) -> None:
    sided = P.copy()
    sided["propeller_side_share"] = 0.1
    plain, other = (propeller_with_rudder(0.0, n, 0.2, 0.0, 0.0, 0, p) for p in (P, sided))
    thrust = plain[0]  # the rudder amidships in a straight flow has no drag
    assert other[0] == plain[0]
    assert other[1] - plain[1] == pytest.approx(0.1 * thrust)
    assert other[2] - plain[2] == pytest.approx(0.1 * thrust * main().rudder.x)


def formula(delta: float, n: float, u: float, v: float, r: float) -> tuple[float, float, float]:
    """The published formulas as they are printed, with J = u / (n D); n not 0."""
    rho, length, draught = BOAT.water_density, BOAT.length, BOAT.draught
    screw, blade = main().propeller, main().rudder
    d, a, b, c = screw.diameter, screw.side_force, screw.yaw_moment, screw.astern_thrust
    speed = math.hypot(u, v)
    across = v / speed + screw.x_wake * r * length / speed
    wake = 1 - (screw.wake_zero - screw.wake_tau * abs(across) - screw.wake_c_p * across**2)
    wake = min(max(wake, 0.0), 1.0) if u > 0 else 1.0
    j_s = u / (n * d)
    j = j_s * wake if u >= 0 else j_s
    k_t = screw.k_t[0] + screw.k_t[1] * j + screw.k_t[2] * j**2
    x = (1 - screw.thrust_deduction) * rho * n**2 * d**4 * k_t
    y, yaw = 0.0, 0.0
    if n < 0:
        k_t = c[1] + c[2] * j_s if j_s >= c[3] else c[0]
        x = rho * n**2 * d**4 * k_t
        y, yaw = (
            s[2] + s[3] * j_s if j_s < -0.35 else s[0] + s[1] * j_s if j_s <= -0.06 else s[4] for s in (a, b)
        )
        y, yaw = y * (n * d) ** 2, yaw * (n * d) ** 2
    elif u < 0:
        y, yaw = ((n * d * screw.pitch_ratio) ** 2 * (s[5] * j_s**2 + s[6] * j_s + s[7]) for s in (a, b))
    y, yaw = 0.5 * rho * length * draught * y, 0.5 * rho * length**2 * draught * yaw

    eta = d / math.sqrt(blade.area * blade.aspect_ratio)
    u_p = u * wake
    if u < 0:
        u_r = u
    elif n > 0 and k_t > 0:
        jet = math.sqrt(u_p**2 + 8 * k_t * (n * d) ** 2 / math.pi)
        inside = u_p + blade.k_x / blade.epsilon * (jet - u_p)
        u_r = blade.epsilon * math.sqrt(eta * inside**2 + (1 - eta) * u_p**2)
    else:
        outside = u_p * blade.epsilon
        inside = outside + n * d * blade.k_x_astern * math.sqrt(8 * abs(k_t) / math.pi)
        s = eta * math.copysign(inside**2, inside) + (1 - eta) * outside**2 + blade.c_pr * u**2
        u_r = math.copysign(math.sqrt(abs(s)), s)
    gamma = blade.gamma_p if v + blade.x * r >= 0 else blade.gamma_n
    v_r = -gamma * (v + blade.flow_lever * length * r)
    lift = 6.13 * blade.aspect_ratio / (2.25 + blade.aspect_ratio)
    normal = 0.5 * rho * blade.area * (u_r**2 + v_r**2) * lift * math.sin(delta - math.atan2(v_r, u_r))
    x -= (1 - blade.thrust_deduction) * normal * math.sin(delta)
    y -= (1 + blade.a_h) * normal * math.cos(delta)
    yaw -= (blade.x + blade.a_h * blade.x_h * length) * normal * math.cos(delta)
    return x, y, yaw


@given(
    st.floats(-0.6, 0.6), st.floats(-16, 16), st.floats(-0.6, 0.6), st.floats(-0.3, 0.3), st.floats(-0.1, 0.1)
)
def test_propeller_and_rudder_are_as_published_in_all_quadrants(
    delta: float, n: float, u: float, v: float, r: float
) -> None:
    assume(abs(n) > 0.1 and math.hypot(u, v) > 1e-3)
    got = propeller_with_rudder(delta, n, u, v, r, 0, P)
    np.testing.assert_allclose(got, formula(delta, n, u, v, r), rtol=1e-9, atol=1e-9)


def test_a_propeller_that_stops_brings_no_jump_ahead() -> None:
    stopped = propeller_with_rudder(0.3, 0.0, 0.4, 0.05, 0.02, 0, P)
    slow = propeller_with_rudder(0.3, 1e-9, 0.4, 0.05, 0.02, 0, P)
    np.testing.assert_allclose(stopped, slow, atol=1e-8)


def test_masses_are_the_published_shares_of_the_water() -> None:
    water = 0.5 * 998.0 * 3.0**2 * 0.20114
    assert BOAT.mass == pytest.approx(0.27078 * water, rel=1e-4)
    assert -BOAT.added_mass_surge == pytest.approx(0.0467 * water, rel=2e-4)
    assert -BOAT.added_mass_sway == pytest.approx(0.2579 * water, rel=1e-4)
    yaw_inertia = BOAT.inertia_z + BOAT.mass * BOAT.x_g**2 - BOAT.added_inertia_yaw
    assert yaw_inertia == pytest.approx(0.0286 * water * 3.0**2, rel=1e-4)


def test_it_settles_where_thrust_balances_the_resistance() -> None:
    screw, n = main().propeller, 10.0
    push = (1 - screw.thrust_deduction) * BOAT.water_density * screw.diameter**4
    a = (1 - screw.wake_zero) / screw.diameter
    drag = 0.5 * BOAT.water_density * BOAT.length * BOAT.draught * -0.02139
    speeds = np.roots(
        [push * screw.k_t[2] * a**2 + drag, push * screw.k_t[1] * n * a, push * screw.k_t[0] * n**2]
    )
    assert sailed(0.0, n, 400.0)[-1, SURGE] == pytest.approx(speeds.max(), abs=1e-3)


@pytest.mark.parametrize("side", [1, -1])
def test_the_bow_turns_to_the_side_of_the_rudder(side: int) -> None:
    turn = sailed(20.0 * side, 10.0, 60.0, speed=0.35)
    assert side * turn[-1, HEADING] > 0.5
    assert side * turn[-1, EAST] > 0.0


def test_full_astern_stops_the_boat_and_then_drives_it_astern() -> None:
    track = sailed(0.0, -10.0, 120.0, speed=0.4)
    assert track[50, SURGE] < 0.4
    assert track[-1, SURGE] < -0.05


def test_the_rudder_turns_no_faster_than_its_servo() -> None:
    angle = np.degrees(sailed(35.0, 0.0, 3.0)[:, ACTUATORS])
    assert np.diff(angle).max() <= 2.0 + 1e-9
    assert angle[5] == pytest.approx(10.0)
    assert angle[-1] == pytest.approx(35.0, abs=1e-3)


def test_commands_beyond_the_limits_are_cut() -> None:
    last = sailed(80.0, 40.0, 5.0)[-1]
    assert last[ACTUATORS] == pytest.approx(main().rudder_max)
    assert last[ACTUATORS + 1] == main().revolutions_max


def test_one_boat_and_a_batch_give_the_same_bits() -> None:
    assert np.array_equal(sailed(25.0, 8.0, 10.0), sailed(25.0, 8.0, 10.0, boats=5))


def test_half_the_thrust_gain_is_half_the_push_at_rest() -> None:
    params = parameters(BOAT)
    params["thruster_gain"] = 0.5
    whole = propeller_with_rudder(0.0, 10.0, 0.0, 0.0, 0.0, 0, P)
    half = propeller_with_rudder(0.0, 10.0, 0.0, 0.0, 0.0, 0, params[0])
    assert half[0] == pytest.approx(0.5 * whole[0])


def recorded() -> Run:
    track = sailed(15.0, 9.0, 20.0, speed=0.3)
    columns = dict(zip(("north", "east", "heading", "surge", "sway", "yaw_rate"), track.T, strict=False))
    time = 0.1 * np.arange(len(track))
    commands = {
        "rudder_main": np.full_like(time, math.radians(15.0)),
        "propeller_main": np.full_like(time, 9),
    }
    return Run("one", {"time": time, **columns, **commands, "applied_rudder_main": track[:, ACTUATORS]})


def test_a_simulated_run_is_replayed_by_its_rudder_and_propeller_columns() -> None:
    run = recorded()
    again = replay(BOAT, run)
    np.testing.assert_allclose(again.pose[-1], run.pose[-1], atol=1e-4)
    assert again.columns["applied_rudder_main"][3] == pytest.approx(run.columns["applied_rudder_main"][3])
    assert (again.columns["propeller_main"] == 9.0).all()


def test_a_run_without_revolutions_is_refused_by_the_missing_column() -> None:
    columns = recorded().columns
    del columns["propeller_main"]
    with pytest.raises(UserError, match="column propeller_main is missing"):
        replay(BOAT, Run("one", columns))


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("effects: [{effect: shallow_water, depth_over_draught: 2}]", "coefficients for deep water"),
        (
            "thrusters: {main: {propeller: {k_t: [0.3, -0.3]}}}",
            "main.propeller: k_t needs 3 coefficients",
        ),
        (
            "thrusters: {main: {rudder: {area: 0}}}",
            "thrusters.main.rudder.area: must be greater",
        ),
        ("thrusters: {main: {kind: screw}}", "'azimuth', 'fixed' or 'propeller_rudder', not 'screw'"),
        ("thrusters: {main: {propeler: {}}}", "did you mean 'propeller'?"),
        ("resistance: {x_0_ahead: 0.02}", "resistance.x_0_ahead: must be at most 0"),
    ],
)
def test_a_boat_file_that_cannot_be_is_refused(tmp_path: Path, line: str, message: str) -> None:
    path = tmp_path / "boat.yaml"
    path.write_text(f"extends: esso_osaka\n{line}\n")
    with pytest.raises(UserError) as error:
        load_boat(path)
    assert message in str(error.value)


def test_a_boat_without_propeller_cannot_take_free_running_tests(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text(HEADINGS + "\n" + "\n".join(f"{0.1 * i:.1f}" + ",0" * 12 for i in range(5)) + "\n")
    assert import_free_running(path, BOAT).time[-1] == pytest.approx(0.4)
    with pytest.raises(UserError, match="boat swamp has no propeller"):
        import_free_running(path, load_boat("swamp"))


HEADINGS = (
    "t [s],x_position_mid [m],u_velo [m/s],y_position_mid [m],vm_velo [m/s],psi_hat [rad],r_angvelo [rad/s],"
    "n_prop [rps],delta_rudder [rad],wind_velo_relative_mid [m/s],wind_dir_relative_mid [rad],"
    "wind_velo_true [m/s],wind_dir_true [rad]"
)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("0.2" + ",0" * 6 + ",,0,0,0,0,0", "row 3, column 'n_prop [rps]': no number"),
        ("0.2" + ",0" * 7 + ",45,0,0,0,0", "row 3 (line 4), column rudder_main: 45 is outside"),
        ("0.1" + ",0" * 12, "row 3 (line 4), column time: 0.1 s does not come after 0.1 s"),
    ],
)
def test_a_wrong_row_of_a_free_running_test_is_named(tmp_path: Path, row: str, message: str) -> None:
    path = tmp_path / "run.csv"
    rows = [f"{0.1 * i:.1f}" + ",0" * 12 for i in range(2)]
    path.write_text("\n".join([HEADINGS, *rows, row]) + "\n")
    with pytest.raises(UserError) as error:
        import_free_running(path, BOAT)
    assert str(error.value).startswith(str(path))
    assert message in str(error.value)


def test_another_table_is_refused_by_the_column_it_lacks(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("time,north\n0.0,1.0\n0.1,1.0\n")
    with pytest.raises(UserError, match=r"column 't \[s\]' is missing"):
        import_free_running(path, BOAT)


@lru_cache(maxsize=32)
def pond(name: str) -> Run:
    return import_free_running(DATA / name, BOAT)


def table(name: str) -> dict[str, float]:
    with (DATA / "published_mmg_params" / name).open() as lines:
        return {row[0]: float(row[1]) for row in list(csv.reader(lines))[1:]}


@on_the_pond
def test_the_boat_file_holds_the_published_table() -> None:
    fitted, built = table("MMG_params.csv"), table("principal_particulars.csv")
    screw, blade = main().propeller, main().rudder
    for name, value in [
        ("massy_nd", BOAT.hull.x_vr - fitted["xvr_nd"]),
        ("massx_nd", fitted["yr_nd"] - BOAT.hull.y_r),
        ("yv_nd", BOAT.hull.y_v),
        ("nv_nd", BOAT.hull.n_v),
        ("nr_nd", BOAT.hull.n_r),
        ("coeff_drag_sway", BOAT.hull.c_d),
        ("cry_cross_flow", BOAT.hull.c_ry),
        ("crn_cross_flow", BOAT.hull.c_rn),
        ("t_prop", screw.thrust_deduction),
        ("w_prop_zero", screw.wake_zero),
        ("tau_prop", screw.wake_tau),
        ("coeff_cp_prop", screw.wake_c_p),
        ("xp_prop_nd", screw.x_wake),
        *((f"kt_coeff{i}", k) for i, k in enumerate(screw.k_t)),
        *((f"ai_coeff_prop{i}", k) for i, k in enumerate(screw.side_force)),
        *((f"bi_coeff_prop{i}", k) for i, k in enumerate(screw.yaw_moment)),
        *((f"ci_coeff_prop{i}", k) for i, k in enumerate(screw.astern_thrust)),
        ("t_rudder", blade.thrust_deduction),
        ("ah_rudder", blade.a_h),
        ("xh_rudder_nd", blade.x_h),
        ("lr_rudder_nd", blade.flow_lever),
        ("kx_rudder", blade.k_x),
        ("kx_rudder_reverse", blade.k_x_astern),
        ("epsilon_rudder", blade.epsilon),
        ("cpr_rudder", blade.c_pr),
        ("gammaN_rudder", blade.gamma_n),
        ("gammaP_rudder", blade.gamma_p),
    ]:
        assert value == pytest.approx(fitted[name], rel=1e-9), name
    assert BOAT.x_g == pytest.approx(built["x_lcg"] * BOAT.length)
    assert (blade.area, blade.aspect_ratio) == (built["area_rudder"], built["lambda_rudder"])
    assert (screw.diameter, screw.pitch_ratio) == (built["dia_prop"], built["pitchr"])
    assert BOAT.wind.lateral_area == built["area_projected_lateral"]


@on_the_pond
def test_the_true_wind_of_the_pond_is_where_it_comes_from() -> None:
    run = pond("random/random_06-Aug-2020_16_24_25_3.csv")
    relative = np.loadtxt(
        DATA / "random/random_06-Aug-2020_16_24_25_3.csv", delimiter=",", skiprows=1, usecols=(9, 10)
    )
    heading, speed = run.columns["heading"], run.columns["wind_speed"]
    off_bow = run.columns["wind_from"] - heading
    ahead = speed * np.cos(off_bow) + run.columns["surge"]
    starboard = speed * np.sin(off_bow) + run.columns["sway"]
    np.testing.assert_allclose(ahead, relative[:, 0] * np.cos(relative[:, 1]), atol=0.01)
    np.testing.assert_allclose(starboard, relative[:, 0] * np.sin(relative[:, 1]), atol=0.01)


@on_the_pond
def test_missing_times_are_named_by_file_and_row_or_cut_on_request() -> None:
    path = DATA / "zigzag" / "zigzag_31-Jul-2020_13_50_28.csv"
    with pytest.raises(UserError, match=r"zigzag_31-Jul-2020_13_50_28\.csv: row 1702, column 't \[s\]'"):
        import_free_running(path, BOAT)
    run = import_free_running(path, BOAT, repair=True)
    assert len(run.time) == 1701
    assert "row 1702" in run.meta.model_dump()["repaired"]


def test_the_left_lever_asks_for_revolutions_and_the_right_one_for_the_rudder() -> None:
    world = world_of(Task.read(boat=BOAT))
    assert world["lever_idle"][0, 0] == 0.0
    assert world["lever_gain"][0, 0] == main().revolutions_max
    assert math.degrees(world["lever_swing"][0, 0]) == pytest.approx(35.0)
