"""A person at the page drives what answers at a link: what is sent, what is recorded, what stops it."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.aboard import Measured

from swamp_rl.link.helm import HOLD, PATIENCE, PERIOD, SETTLE
from swamp_rl.link.network import PERFECT, Faults
from swamp_rl.runs import check_dataset
from swamp_rl.simulator.state import ACTUATORS
from swamp_rl.teleop.berth import Berth
from swamp_rl.teleop.linked import LINK_LOST, Linked
from swamp_rl.teleop.messages import Command
from swamp_rl.teleop.session import DEAD_MAN, ENDED, LET_GO, READY, RUN, Session
from swamp_rl.teleop.view import frame, replayed
from tests.support.driving import accept, command, recordings
from tests.support.link import at_the_start, how_far_off
from tests.support.simulated_link import SimulatedLink

TICK = 0.02
AHEAD = Command(type="command", throttle=1.0, angle=0.0)
RELEASED = Command(type="command", throttle=0.0, angle=0.0)


@dataclass
class Recorder:
    """A recorder's session, the link of its vehicle, and the clock of both [s]."""

    game: Session
    link: SimulatedLink
    now: float = 0.0

    @property
    def pumps(self) -> np.ndarray:
        """(4,) throttles that the vehicle's pumps have reached."""
        return np.array(self.link.vehicle.state[0, ACTUATORS + 4 :])

    def pass_time(self, seconds: float, levers: Callable[[], Command] | None = None) -> None:
        """Let the clock run, a page sending its levers fifty times a second, or nobody."""
        end = self.now + seconds
        while self.now < end - 1e-9:
            self.now = round(self.now + TICK, 6)
            self.link.pass_time(self.now)
            if levers is None:
                self.game.advance(self.now)
            else:
                self.game.command(levers(), self.now)

    def be_ready(self) -> None:
        """The motors are on."""
        self.pass_time(SETTLE * PERIOD + 1.0, lambda: RELEASED)

    def drive(self) -> None:
        """Through the course to its end."""
        self.be_ready()
        while self.game.phase != ENDED and self.now < 120.0:
            self.pass_time(0.1, lambda: command(self.game))


def recorder(folder: Path, telemetry: Faults = PERFECT) -> Recorder:
    """SWAMP at the start of the Camogli course; telemetry: the faults of its network."""
    vehicle = at_the_start()
    link = SimulatedLink(vehicle, telemetry=telemetry)
    craft = Linked(link, Measured(boat="swamp", course="camogli"), "127.0.0.0/24")
    berth = Berth(lambda level, senses: craft, ("unknown",), lambda: recordings(folder))
    return Recorder(Session({"swamp": berth}, np.random.default_rng(1)), link)


def assert_obeys_once_released(at: Recorder) -> None:
    at.pass_time(2 * TICK, lambda: RELEASED)
    assert at.game.trouble is None
    at.pass_time(1.0, lambda: AHEAD)
    assert at.game.phase == RUN and at.pumps.max() > 0.1


@pytest.mark.parametrize("telemetry", [PERFECT, Faults(loss=0.1, delay=(0.001, 0.01))])
def test_a_person_drives_the_vehicle_through_the_course_and_the_run_is_recorded(
    tmp_path: Path, telemetry: Faults
) -> None:
    at = recorder(tmp_path / "runs", telemetry)
    at.drive()
    run = at.game.recordings.read(accept(at.game))
    about = run.meta.model_dump()
    assert (run.meta.outcome, about["link"], about["helm"]) == ("success", "127.0.0.0/24", "person")
    assert run.meta.gates is not None and len(run.meta.gates) == 2
    assert (about["interpolated_rows"] > 0) == (telemetry is not PERFECT)
    assert run.columns["joy_thrust"][0] == 1.0 and run.columns["throttle_bs"][0] > 0.0
    assert np.diff(run.time) == pytest.approx(PERIOD)
    assert not {"wind_speed", "applied_throttle_bs"} & set(run.columns)
    assert check_dataset(tmp_path / "runs") == []
    # What the rows say of motion and commands fits: the simulator goes the same way under them.
    assert how_far_off(run) < 0.2
    assert replayed(run, at.game)["difference"] is None


def test_the_levers_are_not_obeyed_before_the_motors_are_on(tmp_path: Path) -> None:
    at = recorder(tmp_path / "runs")
    at.pass_time(0.5 * SETTLE * PERIOD, lambda: AHEAD)
    assert at.game.phase == READY and at.game.boat.trouble is not None and not at.pumps.any()
    at.pass_time(SETTLE * PERIOD, lambda: AHEAD)
    assert at.game.boat.trouble is None
    assert at.game.phase == READY and not at.pumps.any()  # the throttle was held all the time
    assert json.loads(frame(at.game, at.now))["trouble"] == LET_GO
    assert_obeys_once_released(at)


def test_a_page_that_is_gone_stops_the_vehicle(tmp_path: Path) -> None:
    at = recorder(tmp_path / "runs")
    at.be_ready()
    at.pass_time(2.0, lambda: AHEAD)
    assert at.pumps.max() > 0.1
    at.pass_time(DEAD_MAN + 2 * PERIOD)
    assert not at.link.vehicle.commands()[4:].any()
    at.pass_time(1.0)
    assert not at.pumps.any() and at.game.phase == RUN


def test_a_vehicle_that_falls_silent_is_reported_and_ends_the_run(tmp_path: Path) -> None:
    at = recorder(tmp_path / "runs")
    at.be_ready()
    at.pass_time(4.0, lambda: AHEAD)
    at.link.vehicle.blind.update(at.link.vehicle.addresses.sensors)
    at.pass_time(HOLD + 2 * PERIOD, lambda: AHEAD)
    assert "No telemetry" in (at.game.boat.trouble or "")
    assert at.game.levers == (0.0, 0.0) and not at.link.vehicle.commands()[4:].any()
    assert (at.game.phase, at.game.outcome) == (ENDED, LINK_LOST)
    at.pass_time(PATIENCE, lambda: AHEAD)
    assert not any(module.runs(motor) for module in at.link.vehicle.modules for motor in (0, 1))

    run = at.game.recordings.read(accept(at.game))
    assert run.meta.outcome == LINK_LOST and 30 < len(run.time) < 60
    at.link.vehicle.blind.clear()
    at.pass_time(SETTLE * PERIOD + 1.0, lambda: AHEAD)
    assert at.game.phase == READY and not at.link.vehicle.commands()[4:].any()
    assert_obeys_once_released(at)


def test_a_recorder_that_stood_still_ends_the_run(tmp_path: Path) -> None:
    at = recorder(tmp_path / "runs")
    at.be_ready()
    at.pass_time(4.0, lambda: AHEAD)
    at.now += 2.0
    at.link.pass_time(at.now)
    assert not at.link.vehicle.commands()[4:].any()  # the modules' own time limit
    at.pass_time(0.1, lambda: AHEAD)
    assert (at.game.phase, at.game.outcome) == (ENDED, LINK_LOST)


def test_after_a_run_the_levers_bring_the_vehicle_back(tmp_path: Path) -> None:
    at = recorder(tmp_path / "runs")
    at.drive()
    rows = at.game.rows
    at.pass_time(2.0, lambda: AHEAD)
    assert at.game.phase == ENDED and at.pumps.max() > 0.1 and at.game.rows == rows
    north = at.game.state(at.now)[0]
    at.game.drop(again=True)
    at.pass_time(0.5, lambda: RELEASED)
    assert at.game.phase == READY and at.game.state(at.now)[0] > north


def test_two_thrusters_at_the_stern_obey_their_own_lever(tmp_path: Path) -> None:
    at = recorder(tmp_path / "runs")
    push = Command(type="command", throttle=0.5, angle=0.0, stern_throttle=0.7, stern_azimuth=1.0)
    at.be_ready()
    at.pass_time(1.0, lambda: push)
    asked = at.link.vehicle.commands()
    stern = [at.game.boat.boat.thruster_names.index(name) for name in at.game.boat.stern]
    assert asked[[4 + k for k in stern]] == pytest.approx(0.7, abs=1e-4)
    assert asked[stern] == pytest.approx(np.pi / 2, abs=1e-4)
