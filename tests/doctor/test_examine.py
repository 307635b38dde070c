"""The doctor names what was done to runs, and is silent on sound ones."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat, PropellerRudder, load_boat
from swamp_rl.doctor.examine import examine
from swamp_rl.logs.import_logs import Reading, import_logs
from swamp_rl.logs.mapping import mapping_of
from swamp_rl.runs import Run, append_run, create_dataset, read_dataset
from swamp_rl.runs.import_dataset import About
from swamp_rl.runs.import_foreign import Wishes
from swamp_rl.runs.schema import DatasetMeta, RunMeta
from swamp_rl.simulator.replay import replay
from tests.support.doctored import STEP, Columns, faults, late
from tests.support.from_scratch import number, written
from tests.support.new_boats import new_boat


def test_a_slow_wind_sensor_that_repeats_a_value_is_not_stuck(sound: list[Run], twin: Boat) -> None:
    rng, every = np.random.default_rng(7), 10
    slow = np.round(rng.uniform(1.0, 6.0, 61), 1)
    slow[[21, 22]] = slow[20]
    wind = np.interp(np.arange(601), every * np.arange(61), slow)
    windy = [
        Run(run.name, dict(run.columns) | {"wind_speed": wind, "wind_from": 0.01 * wind}) for run in sound
    ]
    assert faults(windy, twin) == []
    frozen = np.where(np.arange(601) > 400, wind[400], wind)
    windy = [
        Run(run.name, dict(run.columns) | {"wind_speed": frozen, "wind_from": 0.01 * wind}) for run in sound
    ]
    assert [one.code for one in faults(windy, twin)] == ["stuck"]


def test_a_position_that_rests_on_its_last_digit_is_not_repeated(sound: list[Run], twin: Boat) -> None:
    def coarse(run: Run, every: int) -> Run:
        """At rest for three times the run, then the run, of a receiver with a fix each `every` rows."""
        rest = np.random.default_rng(5).random(1803) < 0.1
        columns = {name: np.concatenate([np.full(1803, v[0]), v]) for name, v in run.columns.items()}
        north = np.round(columns["north"] - columns["north"][0], 2)
        north[:1803] = 0.01 * np.cumsum(rest * np.resize([1.0, -1.0], 1803))
        held = np.arange(len(north)) // every * every
        return Run(run.name, columns | {"time": STEP * np.arange(2404), "north": north[held]})

    def repeated(every: int) -> list[float]:
        found = examine([coarse(run, every) for run in sound], twin)
        return [one.figures["rows"] for one in found if one.code == "repeated"]

    assert repeated(1) == []
    assert repeated(4) == [4.0]


@pytest.mark.parametrize("calm_from", [0, 300])
def test_an_anemometer_that_reads_zero_in_a_calm_is_not_stuck(
    sound: list[Run], twin: Boat, calm_from: int
) -> None:
    gusty = np.random.default_rng(8).uniform(1.0, 3.0, 601)
    wind = {"wind_speed": np.where(np.arange(601) >= calm_from, 0.0, gusty), "wind_from": np.zeros(601)}
    calm = [Run(run.name, dict(run.columns) | wind) for run in sound]
    assert examine(calm, twin, measured=False) == examine(sound, twin, measured=False)
    assert faults(calm, twin) == []


def test_sound_runs_have_no_fault(sound: list[Run], twin: Boat) -> None:
    assert faults(sound, twin) == []
    assert faults(sound, None) == []


def test_a_position_that_jumps_for_a_row_is_named_with_its_time(sound: list[Run], twin: Boat) -> None:
    run = Run("glitch", dict(sound[1].columns))
    run.columns["east"] = run.columns["east"].copy()
    run.columns["east"][300] += 40.0
    (found,) = [one for one in faults([sound[0], run, sound[2]], twin) if one.code == "position_jump"]
    assert found.runs == ("glitch",) and "30.0 s of glitch" in found.message
    assert found.figures["longest_jump_m"] == pytest.approx(40.0, abs=1.0)


def test_a_boat_that_is_carried_while_its_thrusters_rest_is_reported_and_one_that_coasts_is_not(
    sound: list[Run], twin: Boat
) -> None:
    first = sound[0].columns
    rest, ashore = np.zeros(300), 0.1 * np.arange(300)
    walked = first["north"][0] + np.minimum(ashore - 20.0, 0.0)  # 1 m/s from 5 s on, to the water at 20 s
    walked = np.maximum(walked, walked[50]) + 0.02 * np.random.default_rng(3).standard_normal(300)
    before = {name: np.full(300, values[0]) for name, values in first.items()} | {"north": walked}
    before |= {"throttle_port": rest, "throttle_starboard": rest}
    carried = {name: np.concatenate([before[name], first[name]]) for name in first}
    day = Run("day", carried | {"time": STEP * np.arange(901)})
    (found,) = [one for one in examine([day], twin) if one.code == "unpowered"]
    assert found.level == "note" and found.runs == ("day",)
    assert found.figures["seconds"] == pytest.approx(15.0, abs=2.0)
    coasting = [
        np.where(first["time"] > 40.0, 0.0, first[f"throttle_{side}"]) for side in ("port", "starboard")
    ]
    cut = replay(
        twin, Run("cut", first | dict(zip(("throttle_port", "throttle_starboard"), coasting, strict=True)))
    )
    assert not [one for one in examine([cut], twin, measured=False) if one.code == "unpowered"]


def test_a_position_that_is_reset_is_divided_by_the_advice_and_not_called_filtered(
    sound: list[Run], twin: Boat, tmp_path: Path
) -> None:
    resets = [
        Run(run.name, run.columns | {"north": run.columns["north"] + 30.0 * (run.time > 30.05)})
        for run in sound
    ]
    (result,) = faults(resets, twin)
    assert result.code == "position_jump"
    about = {"mass": twin.mass, "draught": twin.draught, "water_density": twin.water_density}
    name = str(written(tmp_path, "twin"))
    create_dataset(tmp_path / "runs", DatasetMeta(vehicle=name, sample_rate=10.0, source="measured", **about))
    for run in resets:
        append_run(tmp_path / "runs", run)
    keep = Reading(mapping_of([result.advice.split("'")[1]]))
    import_logs([tmp_path / "runs"], "parquet", tmp_path / "out", About(), Wishes(), keep)
    parts = read_dataset(tmp_path / "out").runs
    assert [len(run.time) for run in parts] == 3 * [300, 299]
    assert faults(list(parts), twin) == []


def scaled(prefix: str, factor: float) -> Callable[[Columns], Columns]:
    return lambda c: {n: v * factor if n.startswith(prefix) else v for n, v in c.items()}


def held(name: str) -> Callable[[Columns], Columns]:
    return lambda c: {**c, name: np.where((c["time"] > 20.0) & (c["time"] < 40.0), c[name][200], c[name])}


def smoothed(c: Columns) -> Columns:
    kernel = np.exp(-np.arange(60) / 5.0)
    kernel /= kernel.sum()
    smooth = {n: np.convolve(np.pad(c[n], (59, 0), "edge"), kernel, "valid") for n in ("north", "east")}
    return {**c, **smooth}


def swapped(one: str, other: str) -> Callable[[Columns], Columns]:
    return lambda c: {**c, one: c[other], other: c[one]}


def time_of(change: Callable[[np.ndarray], np.ndarray]) -> Callable[[Columns], Columns]:
    return lambda c: {**c, "time": change(c["time"])}


CHANGES: dict[str, tuple[Callable[[Columns], Columns], str, str]] = {
    "heading flipped": (lambda c: {**c, "heading": -c["heading"]}, "heading_flipped", "heading"),
    "heading of the stern": (
        lambda c: {**c, "heading": wrapped(c["heading"] + np.pi)},
        "heading_offset",
        "heading",
    ),
    "ENU heading": (
        lambda c: {**c, "heading": wrapped(np.pi / 2 - c["heading"]), "yaw_rate": -c["yaw_rate"]},
        "heading_enu",
        "heading",
    ),
    "yaw of ENU alone": (
        lambda c: {**c, "heading": wrapped(np.pi / 2 - c["heading"])},
        "heading_enu",
        "heading",
    ),
    "axes": (swapped("north", "east"), "axes_exchanged", "north"),
    "axes without a yaw rate": (
        lambda c: {n: v for n, v in swapped("north", "east")(c).items() if n != "yaw_rate"},
        "axes_exchanged",
        "north",
    ),
    "yaw rate flipped": (scaled("yaw_rate", -1.0), "yaw_rate_flipped", "yaw_rate"),
    "yaw rate in degrees": (scaled("yaw_rate", 57.3), "unit", "yaw_rate"),
    "knots": (scaled("surge", 1.944), "unit", "surge"),
    "km/h": (scaled("surge", 3.6), "unit", "surge"),
    "percent": (scaled("throttle_", 100.0), "unit", "throttle_port"),
    "stuck heading": (held("heading"), "stuck", "heading"),
    "stuck north": (held("north"), "stuck", "north"),
    "smoothed": (smoothed, "filtered", "north"),
    "time twice": (time_of(lambda t: np.where(t == t[50], t[49], t)), "time_repeated", "time"),
    "time back": (time_of(lambda t: np.where(t > 30.0, t - 10.0, t)), "time_back", "time"),
    "time jump": (time_of(lambda t: np.where(t > 30.0, t + 2.0, t)), "time_jump", "time"),
    "late": (late(1.5), "latency", "throttle_port"),
    "early": (late(-1.5), "latency", "throttle_port"),
    "sides": (swapped("throttle_port", "throttle_starboard"), "commands_exchanged", "throttle_port"),
    "levels": (scaled("throttle_", -1.0), "levels_flipped", "throttle_port"),
    "one level": (scaled("throttle_port", -1.0), "levels_flipped", "throttle_port"),
    "one level of exchanged sides": (
        lambda c: scaled("throttle_port", -1.0)(swapped("throttle_port", "throttle_starboard")(c)),
        "commands_exchanged",
        "throttle_port",
    ),
    "one level, late": (lambda c: scaled("throttle_port", -1.0)(late(1.5)(c)), "latency", "throttle_port"),
    "constant": (scaled("throttle_", 0.0), "commands_constant", "throttle_port"),
    "clipped": (
        lambda c: {n: np.minimum(v, 0.6) if n.startswith("throttle_") else v for n, v in c.items()},
        "command_clipped",
        "throttle_port",
    ),
}


@pytest.mark.parametrize("what", CHANGES)
def test_a_seeded_fault_is_named_with_its_column(what: str, sound: list[Run], twin: Boat) -> None:
    change, code, column = CHANGES[what]
    found = faults([Run(run.name, change(dict(run.columns))) for run in sound], twin)
    assert any(finding.code == code and column in finding.columns for finding in found), found
    assert all("\n" not in str(finding) for finding in found)


@pytest.mark.parametrize(
    ("units", "advice"),
    [
        ({}, "check its unit"),
        ({"throttle_port": "percent"}, "with --unit throttle_port=percent"),
    ],
)
def test_a_command_that_stays_far_below_its_limit_is_noted(
    units: dict[str, str], advice: str, sound: list[Run], twin: Boat
) -> None:
    meta = RunMeta.model_validate({"units": units})
    small = [Run(run.name, scaled("throttle_port", 0.01)(dict(run.columns)), meta) for run in sound]
    (found,) = [one for one in examine(small, twin) if one.code == "command_small"]
    assert found.level == "note" and found.columns == ("throttle_port",) and advice in found.advice
    assert found.figures["share"] < 0.01 + 1e-9


def test_revolutions_that_reach_one_are_noted_as_a_share_of_full_command() -> None:
    rows = 300
    columns = {name: np.linspace(0.0, 1.0, rows) for name in ("time", "north", "east", "propeller_main")}
    run = Run("run", columns | {"time": 0.1 * np.arange(rows), "heading": np.zeros(rows)})
    larger = load_boat("esso_osaka")
    (main,) = larger.thrusters
    assert isinstance(main, PropellerRudder)
    boat = larger.model_copy(update={"thrusters": (main.model_copy(update={"revolutions_max": 40.0}),)})
    (found,) = [one for one in examine([run], boat) if one.code == "command_small"]
    assert "--map 'propeller_main=COLUMN*40'" in found.advice


def test_an_exchange_and_a_flip_are_reported_as_the_mapping_that_undoes_them(
    sound: list[Run], twin: Boat
) -> None:
    def logged(columns: Columns) -> Columns:
        return {
            **columns,
            "throttle_port": columns["throttle_starboard"],
            "throttle_starboard": -columns["throttle_port"],
        }

    (finding,) = faults([Run(run.name, logged(dict(run.columns))) for run in sound], twin)
    message = "it obeys throttle_port=-throttle_starboard, throttle_starboard=throttle_port"
    assert finding.code == "commands_exchanged" and finding.advice.endswith(message)


def test_a_command_at_its_lever_s_end_is_not_cut_off(sound: list[Run], twin: Boat) -> None:
    def driven(columns: Columns) -> Columns:
        lever = np.clip(columns["throttle_port"] / 0.6, -1.0, 1.0)
        return {**columns, "throttle_port": 0.6 * lever, "joy_thrust": lever}

    joined = [Run(run.name, driven(dict(run.columns))) for run in sound]
    without = [Run(r.name, {n: v for n, v in r.columns.items() if n != "joy_thrust"}) for r in joined]
    assert "command_clipped" in [finding.code for finding in faults(without, twin)]
    assert "command_clipped" not in [finding.code for finding in faults(joined, twin)]


def test_sides_are_known_by_their_names_without_a_boat(sound: list[Run]) -> None:
    change = swapped("throttle_port", "throttle_starboard")
    found = faults([Run(run.name, change(dict(run.columns))) for run in sound], None)
    assert [finding.code for finding in found] == ["commands_exchanged"]


def test_the_size_of_an_offset_and_of_a_latency_is_reported(sound: list[Run], twin: Boat) -> None:
    turned = [Run(r.name, {**r.columns, "heading": wrapped(r.columns["heading"] + 1.0)}) for r in sound]
    (finding,) = faults(turned, twin)
    assert finding.figures["offset_rad"] == pytest.approx(-1.0, abs=0.15)
    (finding,) = faults([Run(r.name, late(1.5)(dict(r.columns))) for r in sound], twin)
    assert finding.figures["latency_s"] == pytest.approx(1.5, abs=0.35)


def test_a_fast_boat_logged_once_a_second_is_sound(tmp_path: Path) -> None:
    """Turns and commands between its rows are neither a filter nor a latency."""
    boat = new_boat(tmp_path, "outboard", 5.0, thrust=3500.0, top_speed=11.0)
    level, angle = boat.thrusters[0].command_columns[::-1]
    rng, rows = np.random.default_rng(1), 6001
    holds = rng.integers(50, 200, 400)
    columns = {name: np.zeros(rows) for name in ("north", "east", "heading", "surge", "sway", "yaw_rate")}
    columns |= {"time": STEP * np.arange(rows)}
    columns[str(level)] = np.repeat(rng.choice([0.2, 0.35, 0.5, 0.7, 0.9], 400), holds)[:rows]
    columns[str(angle)] = np.repeat(np.radians(rng.choice([-25, -12, -5, 0, 5, 12, 25], 400)), holds)[:rows]
    run = dict(replay(boat, Run("fast", columns)).columns)
    for name, deviation in (("north", 0.1), ("east", 0.1), ("heading", 0.02)):
        run[name] = run[name] + deviation * rng.standard_normal(rows)
    logged = ("time", "north", "east", "heading", str(level), str(angle))
    slow = Run(
        "fast", {name: run[name][::10] for name in logged} | {"heading": wrapped(run["heading"][::10])}
    )
    assert faults([slow], boat) == []


def test_a_quick_boat_logged_five_times_a_second_is_sound(tmp_path: Path) -> None:
    """Its motion reaches the band in which a filter is looked for."""
    bluff = {"x_0_ahead": number(-0.4, "1"), "x_0_astern": number(-0.6, "1")}
    boat = load_boat(written(tmp_path, "crossed", resistance=bluff))
    rng, rows = np.random.default_rng(2), 4801
    columns = {name: np.zeros(rows) for name in ("north", "east", "heading", "surge", "sway", "yaw_rate")}
    columns |= {"time": 0.05 * np.arange(rows)}
    ahead, aside, turn = (rng.uniform(*ends, 200) for ends in ((0.2, 0.8), (-0.3, 0.3), (-0.45, 0.45)))
    holds = rng.integers(50, 140, 200)
    for thruster, (side, way) in zip(boat.thrusters, ((1, 1), (-1, -1), (-1, 1), (1, -1)), strict=True):
        levels = np.clip(ahead + side * aside + way * turn, 0.0, 1.0)
        columns[f"throttle_{thruster.name}"] = np.repeat(levels, holds)[:rows]
    run = dict(replay(boat, Run("quick", columns)).columns)
    noisy = {name: run[name] + 0.03 * rng.standard_normal(rows) for name in ("north", "east")}
    noisy["heading"] = wrapped(run["heading"] + 0.008 * rng.standard_normal(rows))
    logged = [name for name in run if name in ("time", *noisy) or name.startswith("throttle_")]
    slow = Run("quick", {name: (run | noisy)[name][::4] for name in logged})
    assert faults([slow], boat) == []


def test_runs_too_short_are_no_fault_and_those_without_a_pose_are(twin: Boat) -> None:
    assert faults([], twin) == []
    few = {"time": np.arange(5) * 0.1, "north": np.zeros(5), "east": np.zeros(5), "heading": np.zeros(5)}
    assert faults([Run("few", few)], twin) == []
    (fault,) = faults([Run("none", {"x": np.zeros(3)})], None)
    assert fault.code == "columns_missing"


def test_an_empty_cell_of_a_command_is_no_latency(sound: list[Run], twin: Boat) -> None:
    holed = [
        Run(run.name, run.columns | {"throttle_port": run.columns["throttle_port"].copy()}) for run in sound
    ]
    for run in holed:
        run.columns["throttle_port"][20] = np.nan
    assert faults(holed, twin) == []
    assert "latency" in [
        finding.code for finding in faults([*holed[:2], Run("late", late(1.5)(sound[2].columns))], twin)
    ]


def test_commands_of_another_boat_are_a_fault(sound: list[Run], twin: Boat) -> None:
    assert "commands_missing" not in {finding.code for finding in faults(sound, twin)}
    (fault,) = (
        finding for finding in faults(sound, load_boat("swamp")) if finding.code == "commands_missing"
    )
    assert "are not of boat swamp, whose commands are azimuth_bs, throttle_bs" in fault.message


def test_runs_without_commands_are_noted(sound: list[Run], twin: Boat) -> None:
    without = [
        Run(run.name, {name: values for name, values in run.columns.items() if "throttle" not in name})
        for run in sound
    ]
    assert "commands_missing" not in {finding.code for finding in examine(sound, twin)}
    (note,) = (finding for finding in examine(without, twin) if finding.code == "commands_missing")
    assert note.level == "note"


def test_one_constant_command_is_reported_in_the_singular_and_a_lever_that_rests_is_none(
    sound: list[Run], twin: Boat
) -> None:
    runs = [
        Run(run.name, run.columns | {"throttle_port": np.full(601, 0.4), "joy_thrust": np.zeros(601)})
        for run in sound
    ]
    (found,) = [one for one in examine(runs, twin) if one.code == "command_constant"]
    assert found.columns == ("throttle_port",)
    assert (found.message, found.advice.split()[0]) == ("never varies", "its")


def test_a_steady_channel_of_few_digits_is_not_stuck_and_a_frozen_one_is(
    sound: list[Run], twin: Boat
) -> None:
    time = np.arange(601)
    turn = np.where(time < 300, 0.3 * np.sin(0.05 * time), 0.0)
    slow = 0.2 + turn + 0.012 * np.sin(np.maximum(time - 300, 0) / 30.0)

    def logged(sway: np.ndarray) -> list[Run]:
        return [Run(run.name, run.columns | {"sway": sway}) for run in sound]

    assert "stuck" not in [one.code for one in examine(logged(np.round(slow, 2)), None)]
    frozen = np.where((time > 100) & (time < 180), slow[100], slow)
    (found,) = [one for one in examine(logged(np.round(frozen, 2)), None) if one.code == "stuck"]
    assert found.columns == ("sway",) and "to 17.9 s" in found.message
