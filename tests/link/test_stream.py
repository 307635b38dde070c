"""Samples of a boat under way: from telemetry in any order, from a served vehicle, from MCAP files."""

import math
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from swamp_rl.errors import UserError
from swamp_rl.link import stream
from swamp_rl.link.helm import Latest
from swamp_rl.link.sensor_line import CAMOGLI
from swamp_rl.link.stamps import AGREED
from swamp_rl.link.stream import Assembler, Sample, samples
from swamp_rl.link.vehicle import Conduct
from swamp_rl.navigation.sensors import Sensors
from swamp_rl.runs import read_dataset
from swamp_rl.runs.export_dataset import export_runs
from swamp_rl.runs.import_telemetry import FIELDS
from swamp_rl.runs.thruster_telemetry import MODULE_FIELDS
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


def test_every_channel_of_a_vehicle_with_noise_has_that_of_its_sensors() -> None:
    sensors = Sensors()
    still = switched_on(Conduct(noise=sensors, timeout=math.inf))
    found = assembled([packet.payload for packet in still.advance(40.0)])
    spread = np.std([sample.senses for sample in found], axis=0)
    place, speed = [sensors.position] * 2, [sensors.velocity] * 2
    assert spread == pytest.approx([*place, sensors.heading, *speed, sensors.yaw_rate], rel=0.15)


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
    export_runs(folder, "mcap", tmp_path / "out")
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


def words_of(packet: bytes) -> list[str]:
    """The numbers of a packet."""
    return packet.replace(b"\0", b"").decode().split()


def stamped(packet: bytes, shift: int) -> bytes:
    """The packet as by a clock that is so many microseconds fast."""
    words = words_of(packet)
    place = FIELDS.index("utc") if len(words) == len(FIELDS) else MODULE_FIELDS.index("utc")
    words[place] = str(int(words[place]) + shift)
    return " ".join(words).encode() + b"\n\0"


@pytest.mark.parametrize("hours", [-1, 24 * 365 * 50], ids=["back", "on"])
def test_samples_go_on_where_the_vehicles_clock_is_set(hours: int) -> None:
    packets = driven()
    half = len(packets) // 2
    after = [stamped(packet, hours * 3_600_000_000) for packet in packets[half:]]
    found = assembled(packets[:half] + after)
    steady = assembled(packets)
    assert 0 < len(steady) - len(found) <= AGREED + 1
    assert {round(sample.time, 6) for sample in found} < {round(sample.time, 6) for sample in steady}
    assert found[-1].time == pytest.approx(steady[-1].time)
    assert np.array_equal(found[-1].commands, steady[-1].commands)


def test_a_packet_of_a_far_future_costs_no_other_packet() -> None:
    packets = driven()
    first = assembled(packets)
    forged = [stamped(packets[0], 10**17), stamped(packets[1], 10**17)]
    found = assembled(packets[:40] + forged + packets[40:])
    assert [sample.time for sample in found] == [sample.time for sample in first]
    assert np.array_equal([s.commands for s in found], [s.commands for s in first])


@pytest.mark.parametrize("field", ["velocity_north", "velocity_east", "gyro_z", "latitude"])
@pytest.mark.parametrize("value", ["1e308", "-1e308", "1e300", "nan", "inf"])
def test_readings_that_no_boat_has_are_ignored(field: str, value: str) -> None:
    words = next(words for packet in driven() if len(words := words_of(packet)) == len(FIELDS))
    words[FIELDS.index(field)] = value
    forged = " ".join(words).encode()
    assembler, latest = Assembler(swamp()), Latest(CAMOGLI)
    assert assembler.feed(forged) is None and assembler.ignored == 1
    latest.feed(forged, 0.0)
    assert latest.stamp is None and latest.ignored == 1


@pytest.mark.parametrize(
    ("field", "value"), [("thrust_reference", 10**14), ("thrust_reference", -1), ("azimuth_reference", 2**31)]
)
def test_references_that_no_module_takes_are_ignored(field: str, value: int) -> None:
    words = next(words for packet in driven() if len(words := words_of(packet)) == len(MODULE_FIELDS))
    words[MODULE_FIELDS.index(field)] = str(value)
    assembler = Assembler(swamp())
    assert assembler.feed(" ".join(words).encode()) is None and assembler.ignored == 1


def test_a_vehicle_whose_telemetry_has_no_fix_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream, "SENSELESS", 1.0)
    vehicle = vehicle_of(network=str(own_network().network))
    vehicle.blind.update(vehicle.addresses.sensors)
    with served(vehicle), pytest.raises(UserError, match=r"without whole telemetry of swamp, \d+ packets"):
        next(samples(str(own_network().network), swamp(), patience=2.0))
