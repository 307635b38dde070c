"""Effects: how their numbers reach a boat's record, and how a wrong list is refused."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.boat import load_boat
from swamp_rl.effects import LIBRARY, apply_effects, neutral_fields, parse_effects
from swamp_rl.errors import UserError
from swamp_rl.simulator import parameters
from swamp_rl.simulator.parameters import boat_fields, thruster_fields

BOAT = load_boat("swamp")
NAMES = BOAT.thruster_names


def with_effects(*entries: dict[str, Any], boats: int = 2) -> Any:
    record = parameters(BOAT, boats)
    apply_effects(record, parse_effects(list(entries), "here", NAMES), NAMES)
    return record


def changed_fields(record: Any) -> set[str]:
    nominal = parameters(BOAT, len(record))
    return {name for name in record.dtype.names if not np.array_equal(record[name], nominal[name])}


def refused(*entries: Any) -> str:
    with pytest.raises(UserError) as error:
        parse_effects(list(entries), "boat.yaml", NAMES)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_the_library_has_the_projects_vocabulary() -> None:
    parameters_of = {name: effect.parameter_names for name, effect in LIBRARY.items()}
    assert parameters_of == {
        "current": ("north", "east"),
        "wind": ("speed", "from"),
        "gusts": ("speed_std", "direction_std", "time_constant"),
        "shallow_water": ("depth_over_draught",),
        "low_battery": ("charge",),
        "thruster_gain": ("gain",),
        "azimuth_lag": ("time_constant",),
        "thruster_kick": ("time", "duration", "throttle", "azimuth"),
        "mass": ("mass",),
        "external_force": ("north", "east"),
        "drifting_current": ("north", "east", "north_rate", "east_rate"),
        "waves": ("force", "frequency", "from", "phase"),
        "thruster_failure": ("time",),
        "azimuth_offset": ("offset",),
        "command_delay": ("delay",),
        "pump_lag": ("time_constant",),
        "channel_swap": (),
        "azimuth_reversed": (),
        "throttle_reversed": (),
        "thrust_scale": ("scale",),
        "advance_thrust_loss": ("factor",),
        "crossflow_thrust_loss": ("coefficient",),
        "thrust_deduction": ("low", "high"),
        "demihull_spacing": ("spacing",),
        "thrust_sag": ("rate",),
        "resistance": ("scale",),
        "linear_drag": ("coefficient",),
        "centre_of_gravity": ("x_g",),
        "yaw_inertia": ("scale",),
        "sway_drag": ("scale",),
        "yaw_damping": ("scale",),
        "hull_coefficients": ("x_vr", "y_v", "y_r", "n_v", "n_r"),
        "wind_coefficients": ("c_x", "c_y", "lateral_centre", "c_n"),
        "hull_asymmetry": ("yaw_moment",),
        "heading_bias": ("bias",),
        "position_delay": ("delay",),
        "position_lever_arm": ("x", "y"),
        "throttle_dead_band": ("below",),
        "thruster_efficiency_curve": ("at_30", "at_60", "at_100"),
        "drag_asymmetry": ("astern", "port"),
        "linear_sway_damping": ("coefficient",),
        "linear_yaw_damping": ("coefficient",),
        "gyro_bias": ("bias",),
        "heading_drift": ("rate",),
        "clock_offset": ("offset",),
        "clock_drift": ("rate",),
        "force_curve": (),
        "rudder_hull_force": ("a_h", "x_h"),
    }


# A failure that never comes and plugs that are not exchanged cannot be written down.
WITHOUT_NUMBER = {"force_curve", "channel_swap", "azimuth_reversed", "throttle_reversed"}
OF_A_RUDDER = {name for name, effect in LIBRARY.items() if effect.needs == "rudder"}
WRITTEN = sorted(set(LIBRARY) - WITHOUT_NUMBER - OF_A_RUDDER)
WRITABLE_NEUTRAL = sorted(set(WRITTEN) - {"thruster_failure"})


@pytest.mark.parametrize("name", WRITABLE_NEUTRAL)
def test_an_effect_at_its_neutral_values_changes_nothing(name: str) -> None:
    effect = LIBRARY[name]
    file = parameters(BOAT)
    numbers = {
        p.name: float(file[p.field].flat[0]) if p.neutral is None else p.neutral for p in effect.parameters
    }
    selector = {"thruster": "all"} if effect.thruster else {}
    assert changed_fields(with_effects({"effect": name} | selector | numbers)) == set()


@pytest.mark.parametrize("name", WRITTEN)
def test_an_effect_changes_its_own_fields_and_no_other(name: str) -> None:
    effect = LIBRARY[name]
    numbers = {p.name: next(x for x in (1.7, 0.7, 0.07) if p.allows(x)) for p in effect.parameters}
    selector = {"thruster": "ss"} if effect.thruster else {}
    record = with_effects({"effect": name} | selector | numbers)
    assert changed_fields(record) == {p.field for p in effect.parameters}
    if effect.thruster:
        for parameter in effect.parameters:
            nominal = parameters(BOAT, 2)[parameter.field]
            assert (record[parameter.field] != nominal).tolist() == [[False, False, True, False]] * 2


def test_swapped_channels_are_exchanged_and_two_swaps_follow_one_another() -> None:
    record = with_effects({"effect": "channel_swap", "thruster": ["ss", "bs"]})
    assert record["channel"].tolist() == [[2.0, 1.0, 0.0, 3.0]] * 2
    assert changed_fields(record) == {"channel"}
    again = with_effects(
        {"effect": "channel_swap", "thruster": ["bs", "ss"]},
        {"effect": "channel_swap", "thruster": ["bs", "bp"]},
    )
    assert again["channel"].tolist() == [[1.0, 2.0, 0.0, 3.0]] * 2


def test_a_reversed_azimuth_changes_the_sign_of_one_thruster_or_of_all() -> None:
    record = with_effects({"effect": "azimuth_reversed", "thruster": "ss"})
    assert record["azimuth_sign"].tolist() == [[1.0, 1.0, -1.0, 1.0]] * 2
    assert changed_fields(record) == {"azimuth_sign"}
    again = with_effects(
        {"effect": "azimuth_reversed", "thruster": "ss"}, {"effect": "azimuth_reversed", "thruster": "all"}
    )
    assert again["azimuth_sign"].tolist() == [[-1.0, -1.0, 1.0, -1.0]] * 2


def test_every_field_of_the_library_stands_in_the_record_at_its_neutral_value() -> None:
    record = parameters(BOAT, 3)
    of_the_file = boat_fields(BOAT) | thruster_fields(BOAT)
    for field, (neutral, per_thruster) in neutral_fields().items():
        if field in of_the_file:
            continue
        assert record[field].shape == ((3, 4) if per_thruster else (3,))
        assert np.all(record[field] == neutral)


def test_pushes_add_up_gains_multiply_and_the_last_replacement_holds() -> None:
    record = with_effects(
        {"effect": "current", "north": 0.1},
        {"effect": "current", "north": 0.2, "east": -0.1},
        {"effect": "thruster_gain", "thruster": "bs", "gain": 0.5},
        {"effect": "thruster_gain", "thruster": "all", "gain": 0.8},
        {"effect": "mass", "mass": 50},
        {"effect": "mass", "mass": 55},
    )
    assert record["current_north"] == pytest.approx([0.3, 0.3])
    assert record["current_east"] == pytest.approx([-0.1, -0.1])
    assert record["thruster_gain"][0] == pytest.approx([0.4, 0.8, 0.8, 0.8])
    assert record["mass"].tolist() == [55.0, 55.0]


def test_a_slow_azimuth_reaches_every_thruster() -> None:
    record = with_effects({"effect": "azimuth_lag", "time_constant": 0.6})
    assert np.all(record["azimuth_time_constant"] == 0.6)


def test_a_parameter_left_out_takes_its_neutral_value() -> None:
    (entry,) = parse_effects([{"effect": "external_force", "east": 2}], "here", NAMES)
    assert dict(entry.values) == {"north": 0.0, "east": 2.0}


@pytest.mark.parametrize(
    ("entry", "text"),
    [
        ("current", "must be a mapping with the key effect"),
        ({"north": 0.1}, "must be a mapping with the key effect"),
        ({"effect": "thrustr_gain"}, "unknown effect 'thrustr_gain'; did you mean 'thruster_gain' or "),
        ({"effect": "zzz"}, "unknown effect 'zzz'; `swamp-rl effects` lists all"),
        ({"effect": ["current"]}, "unknown effect ['current']"),
        ({"effect": "current"}, "gives no number; add north, east"),
        ({"effect": "current", "nort": 0.1}, "unknown key 'nort'; did you mean 'north'?"),
        ({"effect": "current", "thruster": "bs", "north": 0.1}, "unknown key 'thruster'"),
        ({"effect": "current", "north": "0.1"}, "north must be a number [m/s], not '0.1'"),
        ({"effect": "current", "north": True}, "north must be a number [m/s], not true"),
        ({"effect": "current", "north": 10**400}, "north must be a number [m/s]"),
        ({"effect": "current", "north": float("nan")}, "north must be a number [m/s], not nan"),
        ({"effect": "current", "north": {"uniform": [0, 1]}}, "north must be a number [m/s]"),
        ({"effect": "wind", "from": 1.0}, "speed [m/s] is missing"),
        (
            {"effect": "wind", "speed": -1, "from": 0},
            "speed -1 is out of range; allowed: at least 0 and at most",
        ),
        ({"effect": "wind", "speed": 4, "from": 270}, "from 270 is out of range"),
        ({"effect": "mass", "mass": 0}, "mass 0 is out of range; allowed: above 0 [kg]"),
        ({"effect": "shallow_water", "depth_over_draught": 1.49}, "the towing-tank tests end at 1.5"),
        ({"effect": "thruster_gain", "gain": 0.5}, "thruster is missing; add one of bs, bp, ss, sp, all"),
        ({"effect": "thruster_gain", "thruster": "stern", "gain": 0.5}, "unknown thruster 'stern'"),
        ({"effect": "thruster_gain", "thruster": 1, "gain": 0.5}, "unknown thruster 1"),
        ({"effect": "channel_swap"}, "thruster must be two of them such as [bs, bp]"),
        ({"effect": "channel_swap", "thruster": ["bs", "bs"]}, "thruster must be two of them"),
        ({"effect": "channel_swap", "thruster": ["bs", "all"]}, "thruster must be two of them"),
        ({"effect": "channel_swap", "thruster": ["bs", "stern"]}, "unknown thruster 'stern'"),
        ({"effect": "command_delay", "delay": 2.5}, "at most 2 [s]"),
    ],
)
def test_a_wrong_entry_is_refused_with_its_place_and_what_is_known(entry: Any, text: str) -> None:
    good = {"effect": "current", "north": 0.1}
    message = refused(good, entry)
    assert message.startswith("boat.yaml: effects[1]")
    assert text in message


def test_the_shallowest_water_of_the_tank_tests_is_still_allowed() -> None:
    assert np.all(
        with_effects({"effect": "shallow_water", "depth_over_draught": 1.5})["depth_over_draught"] == 1.5
    )


@given(key=st.text(min_size=1, max_size=12), name=st.sampled_from(sorted(LIBRARY)))
def test_an_unknown_key_of_an_effect_is_always_named(key: str, name: str) -> None:
    if key in ("effect", "thruster", *LIBRARY[name].parameter_names):
        return
    assert f"{name}: unknown key {key!r}" in refused({"effect": name, key: 1.0})
