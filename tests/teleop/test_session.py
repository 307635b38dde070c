"""A run as it is driven: when it starts and ends, who drives, what stops it, and its exact replay."""

import math
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.course import load_course
from swamp_rl.errors import UserError
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.runs import Run, check_dataset, read_dataset, read_run
from swamp_rl.simulator import parameters, tank
from swamp_rl.simulator.replay import replay
from swamp_rl.simulator.state import NORTH, SURGE
from swamp_rl.simulator.step import step
from swamp_rl.teleop.messages import Choose, Command
from swamp_rl.teleop.rows import largest_difference
from swamp_rl.teleop.session import ENDED, READY, RUN, Session
from tests.support.driving import BOAT, accept, command, drive, session

AHEAD = Command(type="command", throttle=1.0, angle=0.0)


def recorded(game: Session, name: str) -> Run:
    return game.recordings.read(name)


def test_a_run_is_kept_from_the_first_thrust_with_the_instants_of_its_gates(tmp_path: Path) -> None:
    game = session(tmp_path / "runs")
    start = game.boat.now.state[NORTH]
    drive(game)
    run = recorded(game, accept(game))
    north = run.columns["north"]
    assert run.time[0] == 0.0 and north[0] == start and run.columns["surge"][0] == 0.0
    assert run.columns["joy_thrust"][0] > 0.0
    assert run.meta.outcome == "success" and run.meta.gates is not None
    for gate, instant in zip(load_course("camogli").gates, run.meta.gates, strict=True):
        row = int(np.flatnonzero(run.time == instant)[0])
        assert north[row - 1] < gate.centre.north <= north[row]
    # The clock of the page and of the board runs from the first gate on.
    assert run.time[-1] - run.meta.gates[0] == pytest.approx(run.meta.model_dump()["seconds"])
    assert check_dataset(tmp_path / "runs") == []


@pytest.mark.parametrize("level", ["calm", "standard", "severe"])
def test_a_driven_run_replays_to_the_bit(tmp_path: Path, level: str) -> None:
    game = session(tmp_path / "runs", level, {"ai": ScriptedPilot(2)})
    now = 0.0
    while game.phase != ENDED:
        # Commands at odd instants, kicks of the stern, and the helm given away and taken back.
        kicks = 10 < game.rows < 30 or 50 < game.rows < 60
        kicked = {"stern_throttle": 0.7, "stern_azimuth": -1.3} if kicks else {}
        game.command(command(game, **kicked), now)
        if game.phase == RUN and round(now / 0.037) % 60 == 0:
            game.change_helm(now)
        now += 0.037
    run = recorded(game, accept(game))
    assert run.columns["throttle_ss"].max() == 0.7
    assert set(run.columns["driver"]) == {0.0, 1.0}
    assert largest_difference(run, BOAT) == 0.0


def test_in_still_water_any_tool_that_replays_commands_finds_the_track(tmp_path: Path) -> None:
    game = session(tmp_path / "runs")
    drive(game)
    path = tmp_path / "runs" / f"{accept(game)}.csv"
    run = read_run(path)
    np.testing.assert_allclose(replay(BOAT, run).pose[:, :2], run.pose[:, :2], atol=1e-6)


def test_a_command_shows_in_the_very_next_look_and_still_is_one_command_a_step(tmp_path: Path) -> None:
    game = session(tmp_path / "runs")
    game.command(AHEAD, 0.0)
    game.command(AHEAD, 0.2)
    before = game.state(0.25)
    game.command(Command(type="command", throttle=0.0, angle=0.0), 0.25)
    after = game.state(0.25)
    assert after[SURGE] < before[SURGE]
    assert after[NORTH] < before[NORTH]
    # The step's end is where the new command leads from the step's beginning: nothing jumps there.
    foreseen = game.boat.ahead.state
    assert game.state(0.3 - 1e-9) == pytest.approx(foreseen, abs=1e-6)
    game.advance(0.3 + 1e-9)
    assert (game.boat.now.state == foreseen).all()
    assert game.state(0.3 + 1e-9) == pytest.approx(foreseen, abs=1e-6)


def test_between_steps_the_boat_is_where_a_finer_simulation_puts_it(tmp_path: Path) -> None:
    coarse = session(tmp_path / "runs")
    turn = Command(type="command", throttle=1.0, angle=1.0)
    coarse.command(turn, 0.0)
    state = coarse.boat.now.state[None].copy()
    commands = coarse.boat.ahead.commands[None]
    for tick in range(1, 51):
        step(state, parameters(BOAT), tank(BOAT), commands, np.zeros(1, np.uint64), 0.02, 1)
        coarse.command(turn, tick * 0.02)
        np.testing.assert_allclose(coarse.state(tick * 0.02)[:3], state[0, :3], atol=1e-3)


def test_without_commands_the_thrusters_stop_after_a_quarter_of_a_second(tmp_path: Path) -> None:
    game = session(tmp_path / "runs")
    game.command(AHEAD, 0.0)
    game.advance(0.249)
    assert game.levers == (1.0, 0.0)
    game.advance(0.251)
    assert game.levers == (0.0, 0.0)
    game.advance(0.5)
    assert (game.boat.now.commands == 0.0).all()


def test_a_page_that_lost_the_focus_stops_the_thrusters_at_once_even_the_pilots(tmp_path: Path) -> None:
    game = session(tmp_path / "runs", pilots={"ai": ScriptedPilot(0)})
    game.command(AHEAD, 0.0)
    game.change_helm(0.05)
    game.command(AHEAD, 0.1)
    assert game.levers[0] > 0.0
    game.command(Command(type="command", throttle=1.0, angle=0.0, live=False), 0.15)
    assert game.levers == (0.0, 0.0)


def test_the_clock_waits_for_the_first_thrust(tmp_path: Path) -> None:
    game = session(tmp_path / "runs")
    game.command(Command(type="command", throttle=0.0, angle=0.5), 50.0)
    game.advance(100.0)
    assert game.phase == READY
    assert game.boat.now.state[6] == 0.0


def test_a_machine_that_stalled_does_not_make_the_boat_leap(tmp_path: Path) -> None:
    game = session(tmp_path / "runs")
    game.command(AHEAD, 0.0)
    game.advance(60.0)
    assert game.boat.now.state[6] < 1.0


def test_retry_is_the_same_start_and_weather_and_discard_another(tmp_path: Path) -> None:
    game = session(tmp_path / "runs", "severe")
    first, drawn = game.boat.now.state.copy(), game.boat.drawn
    drive(game)
    game.drop(again=True)
    assert (game.boat.now.state == first).all() and game.boat.drawn == drawn
    drive(game)
    game.drop(again=False)
    assert game.boat.drawn != drawn
    assert list((tmp_path / "runs" / "unfinished").glob("run-*")) == []
    assert list((tmp_path / "runs").glob("*.csv")) == []


def test_a_run_that_fails_before_the_first_gate_is_kept_as_failed(tmp_path: Path) -> None:
    game = session(tmp_path / "runs", "severe")
    now = 0.0
    while game.phase != ENDED:
        game.command(Command(type="command", throttle=1.0, angle=0.9), now)
        now += 0.05
    run = recorded(game, accept(game))
    assert run.meta.outcome in ("buoy", "out_of_bounds") and run.meta.gates is None
    assert run.time[0] == 0.0 and game.recordings.count == 1 and game.recordings.board == []
    assert check_dataset(tmp_path / "runs") == []


def test_the_pilot_watches_takes_over_and_where_the_person_corrected_it_is_stored(tmp_path: Path) -> None:
    game = session(tmp_path / "runs", pilots={"ai": ScriptedPilot(0)})
    now = 0.0
    while game.phase != ENDED:
        if game.phase == RUN and game.rows in (30, 60):
            game.change_helm(now)
        game.command(command(game, throttle=0.75), now)
        now += 0.1
    run = recorded(game, accept(game))
    about = run.meta.model_dump()
    assert (about["helm"], about["pilot"], about["corrections"]) == ("both", "ai", 1)
    driver, thrust = run.columns["driver"], run.columns["joy_thrust"]
    assert np.count_nonzero(np.diff(driver)) == 2
    assert (thrust[driver == 0.0] == 0.75).all()
    assert (thrust[driver == 1.0] == run.columns["pilot_thrust"][driver == 1.0]).all()
    assert len(run.columns["pilot_angle"]) == len(run.time)


def test_a_pilot_alone_brings_the_boat_home(tmp_path: Path) -> None:
    game = session(tmp_path / "runs", pilots={"ai": ScriptedPilot(0)})
    game.change_helm(0.0)
    now = 0.0
    while game.phase != ENDED:
        game.command(Command(type="command", throttle=0.0, angle=0.0), now)
        now += 0.1
    assert game.outcome == "success"
    assert game.about()["helm"] == "pilot"


def test_without_a_pilot_there_is_none_to_take_over(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="--pilot"):
        session(tmp_path / "runs").change_helm(0.0)


@pytest.mark.parametrize("choice", [{"level": "../severe"}, {"level": "none"}, {"pilot": "ghost"}])
def test_only_what_is_offered_can_be_chosen(tmp_path: Path, choice: dict[str, str]) -> None:
    with pytest.raises(UserError, match="there is no such"):
        session(tmp_path / "runs").choose(Choose(type="choose", **choice))


def test_level_and_pilot_stay_during_a_run(tmp_path: Path) -> None:
    game = session(tmp_path / "runs")
    game.command(AHEAD, 0.0)
    game.choose(Choose(type="choose", nickname="  Ada\n<b> "))
    assert game.nickname == "Ada <b>"
    with pytest.raises(UserError, match="before a run"):
        game.choose(Choose(type="choose", level="severe"))


def test_the_board_is_the_fastest_successes_and_outlives_the_recorder(tmp_path: Path) -> None:
    game = session(tmp_path / "runs")
    for name in ("Ada", "Bo"):
        game.choose(Choose(type="choose", nickname=name))
        drive(game)
        accept(game)
    board = game.recordings.board
    assert [row["nickname"] for row in board] != []
    assert board == sorted(board, key=lambda row: row["seconds"]) and len(board) == game.recordings.count == 2
    game.recordings.close()
    again = session(tmp_path / "runs")
    assert again.recordings.board == board
    assert {run.meta.model_dump()["nickname"] for run in read_dataset(tmp_path / "runs").runs} == {
        "Ada",
        "Bo",
    }


def test_wind_and_current_are_those_of_the_episode(tmp_path: Path) -> None:
    game = session(tmp_path / "runs", "standard")
    effects = {effect["effect"]: effect for effect in game.boat.drawn["effects"]}
    north, east, current_north, current_east = game.boat.weather(game.state(0.0))
    assert math.hypot(north, east) == pytest.approx(effects["wind"]["speed"])
    assert math.remainder(math.atan2(east, north) - effects["wind"]["from"], 2 * math.pi) == pytest.approx(
        0.0
    )
    assert (current_north, current_east) == (effects["current"]["north"], effects["current"]["east"])
