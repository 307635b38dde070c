"""A pilot drives what answers at a link, whatever the network does, and stops it at the end."""

import gc
import math
import weakref

import numpy as np
import pytest
from swamp_rl.envs.aboard import Aboard

from swamp_rl.link.helm import HOLD, PATIENCE, Voyage, helm
from swamp_rl.link.module import TIMEOUT
from swamp_rl.link.network import Faults
from swamp_rl.link.vehicle import Vehicle
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.simulator.state import ACTUATORS
from tests.support.link import at_the_start, swamp, vehicle_of
from tests.support.simulated_link import SimulatedLink

POOR = Faults(loss=0.2, doubled=0.1, delay=(0.0, 0.15))
"""A fifth of the datagrams lost, a tenth doubled, and many overtaken by the next."""


def sailed(faults: Faults, seconds: float = math.inf, seed: int = 0) -> tuple[SimulatedLink, Voyage]:
    """The line-of-sight pilot at the helm."""
    link = SimulatedLink(at_the_start(), faults, seed)
    bridge = Aboard(LineOfSightPilot(), boat=swamp(), course="camogli")
    return link, helm(link, bridge, 4, link.clock, seconds)


def pumps(vehicle: Vehicle) -> np.ndarray:
    """(4,) throttles that the pumps have reached."""
    return vehicle.state[0, ACTUATORS + 4 :]


@pytest.mark.parametrize("faults", [Faults(), POOR], ids=["good network", "poor network"])
def test_a_pilot_sails_the_course_over_a_network(faults: Faults) -> None:
    _, voyage = sailed(faults)
    assert voyage.outcome == "success"
    times = np.array(voyage.rows)[:, 0]
    assert np.all(np.diff(times) > 0.0)
    assert (voyage.silent > 0) == (faults is POOR)


def test_the_motors_are_stopped_and_switched_off_at_the_end() -> None:
    link, voyage = sailed(Faults(), seconds=5.0)
    assert voyage.outcome == "ended" and pumps(link.vehicle).max() > 0.1
    link.pass_time(link.clock() + 0.2)
    assert not pumps(link.vehicle).any()
    assert not any(module.runs(0) or module.runs(1) for module in link.vehicle.modules)


def test_the_pumps_stop_when_the_sender_dies() -> None:
    link = SimulatedLink(at_the_start())

    class Killed(BaseException):
        pass

    class Dies(Aboard):
        def decide(self, time: float, senses: np.ndarray) -> np.ndarray:
            if time > 5.0:
                link.send = lambda k, command: None  # type: ignore[method-assign]  # nothing is sent any more
                raise Killed
            return super().decide(time, senses)

    with pytest.raises(Killed):
        helm(link, Dies(LineOfSightPilot(), boat=swamp(), course="camogli"), 4, link.clock)
    died = link.clock()
    link.pass_time(died + TIMEOUT - 0.2)
    assert pumps(link.vehicle).max() > 0.1
    link.pass_time(died + TIMEOUT + 0.2)
    assert not pumps(link.vehicle).any()


def test_without_telemetry_the_pumps_are_stopped_and_then_the_link_is_given_up() -> None:
    vehicle = at_the_start()
    link = SimulatedLink(vehicle)
    bridge = Aboard(LineOfSightPilot(), boat=swamp(), course="camogli")
    helm_until_5 = bridge.decide
    went_blind, stopped = [], []

    def decide(time: float, senses: np.ndarray) -> np.ndarray:
        if time > 5.0:
            vehicle.blind.update(vehicle.addresses.sensors)
            went_blind.append(link.clock())
        return helm_until_5(time, senses)

    send = link.send

    def watched(k: int, command: object) -> None:
        if vehicle.blind and not stopped and not vehicle.commands()[4:].any():
            stopped.append(link.clock())
        send(k, command)  # type: ignore[arg-type]

    bridge.decide, link.send = decide, watched  # type: ignore[method-assign]
    voyage = helm(link, bridge, 4, link.clock)
    assert voyage.outcome is None
    assert stopped[0] - went_blind[0] == pytest.approx(HOLD, abs=0.25)
    assert link.clock() - went_blind[0] == pytest.approx(PATIENCE, abs=0.25)


def test_a_vehicle_that_never_answers_is_given_up() -> None:
    vehicle = vehicle_of()
    vehicle.dead.update(vehicle.addresses.sensors)
    link = SimulatedLink(vehicle)
    voyage = helm(link, Aboard(LineOfSightPilot(), boat=swamp(), course="camogli"), 4, link.clock)
    assert (voyage.outcome, voyage.rows) == (None, [])


class Forgetful:
    """A bridge whose every decision leaves garbage that only the collector finds."""

    outcome = None
    levers = np.zeros(2)

    def __init__(self) -> None:
        self.left: list[weakref.ref[Forgetful.Thing]] = []

    class Thing:
        """Something that holds itself."""

    def decide(self, time: float, senses: np.ndarray) -> np.ndarray:
        thing = self.Thing()
        thing.self = thing  # type: ignore[attr-defined]
        self.left.append(weakref.ref(thing))
        assert not gc.isenabled()
        return np.zeros(8)


def test_garbage_is_collected_between_commands_and_not_before_one() -> None:
    link, bridge = SimulatedLink(at_the_start()), Forgetful()
    kept = gc.get_freeze_count()
    helm(link, bridge, 4, link.clock, 5.0)
    assert len(bridge.left) > 30 and not any(one() for one in bridge.left[:-1])
    assert gc.isenabled() and gc.get_freeze_count() == kept
