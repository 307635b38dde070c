"""Samples of a boat under way: from telemetry in any order, from a served vehicle, from MCAP files."""

import math
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.link.stream import Assembler, Sample, samples
from swamp_rl.link.vehicle import Conduct
from swamp_rl.runs import read_dataset
from swamp_rl.runs.export_dataset import export_runs
from tests.support.link import own_network, served, swamp, switched_on, tell, vehicle_of

pytestmark = pytest.mark.timed


def driven() -> list[bytes]:
    """Packets of five seconds in which the throttle of the first jet rises by a tenth each second."""
    vehicle, packets = switched_on(), []
    for second in range(5):
        tell(vehicle, 0, f"1004 0 {10_000 * (second + 1)}", "1004 1 123853")
        packets += [packet.payload for packet in vehicle.advance(second + 1.0)]
    return packets


def assembled(packets: list[bytes]) -> list[Sample]:
    """The samples of packets, in turn."""
    assembler = Assembler(swamp())
    return [sample for packet in packets if (sample := assembler.feed(packet)) is not None]


def test_a_sample_holds_the_commands_of_its_interval_and_the_motion_at_its_time() -> None:
    found = assembled(driven())
    assert [sample.time for sample in found] == pytest.approx(0.1 * np.arange(len(found)))
    throttle = [sample.commands[4] for sample in found]
    assert throttle == pytest.approx([0.1 * (1 + row // 10) for row in range(len(found))])
    assert found[-1].commands[0] == pytest.approx(np.pi / 2, abs=1e-5)
    assert found[-1].senses[4] == pytest.approx(np.diff([s.senses[1] for s in found[-2:]])[0] / 0.1, abs=0.05)


def test_packets_that_come_late_twice_or_damaged_change_no_sample() -> None:
    packets = driven()
    rng = np.random.default_rng(3)
    shaken = []
    for packet in packets:
        shaken += [packet] * (1 + int(rng.random() < 0.2)) + [packet[:-40]] * int(rng.random() < 0.1)
    for i in range(10, len(shaken) - 10, 7):  # a late one behind those that were sent after it
        if len(shaken[i].split()) == 40:
            shaken.insert(i + 8, shaken[i])
    clean, found = assembled(packets), assembled(shaken)
    assert len(found) == len(clean)
    for one, other in zip(found, clean, strict=True):
        assert np.array_equal(one.commands, other.commands) and np.array_equal(one.senses, other.senses)


def test_a_served_vehicle_is_heard_and_then_let_go_of() -> None:
    vehicle = switched_on(Conduct(timeout=math.inf), own_network().text)
    tell(vehicle, 1, "1004 0 30000")
    with served(vehicle):
        heard = samples(vehicle.addresses.text, vehicle.boat)
        found = list(islice(heard, 12))
        heard.close()
    assert found[0].commands[5] == pytest.approx(0.3)
    assert np.diff([sample.time for sample in found]) == pytest.approx(0.1)
    assert vehicle.ignored == {}


def test_a_silent_address_is_given_up_in_one_line() -> None:
    with pytest.raises(UserError, match=r"no telemetry for 0\.1 s"):
        next(samples(own_network().text, swamp(), patience=0.1))


def test_an_mcap_file_gives_the_rows_of_its_run(folder: Path, tmp_path: Path) -> None:
    run = read_dataset(folder).runs[0]
    export_runs(folder, "mcap", tmp_path / "out", swamp())
    found = list(samples(tmp_path / "out" / "one.mcap", swamp()))
    assert [sample.time for sample in found] == pytest.approx((run.time - run.time[0]).tolist())
    assert np.array([sample.senses for sample in found])[:, :3] == pytest.approx(run.pose)
    assert np.array([sample.commands for sample in found]) == pytest.approx(
        run.commands(swamp().thruster_names)
    )


def test_the_vehicles_motors_are_off_until_they_are_switched_on() -> None:
    vehicle = vehicle_of()
    tell(vehicle, 0, "1004 0 50000", "1004 1 123853")
    vehicle.advance(1.0)
    assert not vehicle.commands().any()
