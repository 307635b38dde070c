"""The datagrams of thesis 6.2: its example byte for byte, every command there and back, and garbage."""

import math
import socket

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from swamp_rl.link.module import GEAR
from swamp_rl.link.protocol import (
    ENABLE,
    HOME,
    LONGEST,
    MAX_SPEED,
    MODULE,
    POWER,
    REFERENCE,
    SENSORS,
    Command,
    DatagramError,
    decoded,
    encoded,
)
from swamp_rl.link.serve import AT_ONCE, receive
from swamp_rl.link.socket_link import socket_link
from swamp_rl.link.vehicle import Conduct
from swamp_rl.runs.thruster_telemetry import STEPS_PER_TURN, azimuth_angle, azimuth_steps
from swamp_rl.simulator.state import ACTUATORS
from tests.support.link import own_network, vehicle_of

EXAMPLE = {  # as printed, sent by Matlab's fwrite to 192.168.29.201, port 2968
    "1002 0 1": Command(POWER, (0, 1)),
    "1002 1 1": Command(POWER, (1, 1)),
    "1003 0 1": Command(ENABLE, (0, 1)),
    "1003 1 1": Command(ENABLE, (1, 1)),
    "1007": Command(HOME),
    "1005 7000": Command(MAX_SPEED, (7000,)),
    "1004 1 41284": Command(REFERENCE, (1, 41284)),
    "1004 0 50000": Command(REFERENCE, (0, 50000)),
    "1003 0 0": Command(ENABLE, (0, 0)),
    "1003 1 0": Command(ENABLE, (1, 0)),
    "1002 0 0": Command(POWER, (0, 0)),
    "1002 1 0": Command(POWER, (1, 0)),
}
TABLE_5_5 = {  # angle [deg]: steps, as printed
    **{-360: -495411, -315: -433485, -270: -371558, -225: -309632, -180: -247706, -135: -185779},
    **{-90: -123853, -45: -61926, 0: 0, 45: 61926, 90: 123853, 135: 185779, 180: 247706, 225: 309632},
    **{270: 371558, 315: 433485, 360: 495411, 540: 743117, 720: 990822},
}


def test_the_printed_example_is_what_is_sent_and_what_is_understood() -> None:
    for text, command in EXAMPLE.items():
        assert encoded(command) == text.encode() + b"\0"
        assert decoded(text.encode(), MODULE) == decoded(text.encode() + b"\0", MODULE) == command


@pytest.mark.parametrize("angle", TABLE_5_5)
def test_steps_are_those_of_the_printed_table(angle: int) -> None:
    assert abs(azimuth_steps(math.radians(angle)) - TABLE_5_5[angle]) <= 1


def test_the_printed_45_degrees_are_30_by_the_printed_table() -> None:
    assert math.degrees(azimuth_angle(41284)) == pytest.approx(30.0, abs=0.001)
    assert math.degrees(azimuth_angle(41284, 4096 * GEAR)) == pytest.approx(30.75, abs=0.001)
    assert 4096 * GEAR == 483_328
    assert pytest.approx(80.63, abs=0.01) == 41284 * 360 / 45 / 4096  # no gear of the thesis has this ratio


@pytest.mark.parametrize("steps_per_turn, degrees", [(STEPS_PER_TURN, 30.0), (4096 * GEAR, 30.75)])
def test_the_example_drives_the_starboard_bow_jet_alone(steps_per_turn: float, degrees: float) -> None:
    vehicle = vehicle_of(Conduct(timeout=math.inf, steps_per_turn=steps_per_turn), "192.168.29.0/24")
    assert vehicle.addresses.modules[0] == ("192.168.29.201", 2968)
    on, off = list(EXAMPLE)[:8], list(EXAMPLE)[8:]
    for text in on:
        vehicle.receive(text.encode(), ("192.168.29.100", 5000), ("192.168.29.201", 2968))
    vehicle.advance(2.0)
    azimuths, throttles = np.split(vehicle.state[0, ACTUATORS:], 2)
    assert vehicle.boat.thruster_names[0] == "bs"
    assert np.degrees(azimuths) == pytest.approx([degrees, 0, 0, 0], abs=0.01)
    assert throttles == pytest.approx([0.5, 0, 0, 0])
    for text in off:
        vehicle.receive(text.encode(), ("192.168.29.100", 5000), ("192.168.29.201", 2968))
    vehicle.advance(2.5)
    azimuths, throttles = np.split(vehicle.state[0, ACTUATORS:], 2)
    assert not throttles.any() and np.degrees(azimuths[0]) == pytest.approx(degrees, abs=0.01)


COMMANDS = st.one_of(
    st.tuples(st.sampled_from([POWER, ENABLE]), st.integers(0, 1), st.integers(0, 1)),
    st.tuples(st.just(REFERENCE), st.just(0), st.integers(0, 100_000)),
    st.tuples(st.just(REFERENCE), st.just(1), st.integers(-(2**31), 2**31 - 1)),
    st.tuples(st.just(MAX_SPEED), st.integers(0, 2**31 - 1)),
    st.just((HOME,)),
    st.tuples(st.sampled_from([10000, 10001]), st.integers(0, 1)),
    st.tuples(st.just(10002), st.integers(1, 254), st.integers(1, 65535)),
)


@given(COMMANDS)
def test_every_command_of_a_module_comes_back_as_it_was(numbers: tuple[int, ...]) -> None:
    command = Command(numbers[0], numbers[1:])
    sent = encoded(command)
    assert len(sent) <= LONGEST and sent.endswith(b"\0")
    assert decoded(sent, MODULE) == command


@given(st.sampled_from([10001, 10002]), st.integers(1, 254), st.integers(1, 65535))
def test_one_opcode_means_two_things(opcode: int, byte: int, port: int) -> None:
    assert decoded(encoded(Command(opcode, (byte, port))), SENSORS).arguments == (byte, port)
    switch = encoded(Command(10001, (1,)))
    assert decoded(switch, MODULE).arguments == (1,)
    with pytest.raises(DatagramError):
        decoded(switch, SENSORS)


@given(st.one_of(st.binary(max_size=80), st.text("0123456789- \0\n", max_size=40).map(str.encode)))
def test_any_bytes_are_a_command_in_range_or_refused(datagram: bytes) -> None:
    for program in (MODULE, SENSORS):
        try:
            command = decoded(datagram, program)
        except DatagramError as error:
            assert str(error)
            continue
        assert decoded(encoded(command), program) == command


@pytest.mark.parametrize(
    "datagram",
    [
        *(b"", b"\0", b" ", b"1004", b"1004 0", b"1004 0 1 2", b"1002 2 1", b"1002 0 2", b"1004 0 100001"),
        *(b"1004 0 -1", b"1004 1 2147483648", b"1005 -1", b"1006", b"1004 0 1e3", b"1004 0 0x10", b"1007 0"),
        *("1004 0 ٥".encode(), b"1004 0 5" + b" " * 80, b"10002 0 80", b"10002 201 65536", b"1004\xff0 5"),
    ],
)
def test_what_is_no_command_is_counted_and_changes_nothing(datagram: bytes) -> None:
    vehicle = vehicle_of()
    before = vars(vehicle.modules[0]).copy()
    vehicle.receive(datagram, vehicle.addresses.recipient, vehicle.addresses.modules[0])
    assert vehicle.ignored.total() == 1
    assert vars(vehicle.modules[0]) == before


def test_a_datagram_from_another_network_is_foreign() -> None:
    vehicle = vehicle_of()
    vehicle.receive(b"1002 0 1\0", ("10.0.0.5", 2968), vehicle.addresses.modules[0])
    assert vehicle.ignored == {"foreign": 1} and not vehicle.modules[0].power[0]


def test_a_flood_is_ignored_beyond_a_thousand_datagrams_a_second() -> None:
    vehicle = vehicle_of()
    for _ in range(1500):
        vehicle.receive(b"1002 0 1\0", vehicle.addresses.recipient, vehicle.addresses.modules[0])
    assert vehicle.ignored == {"too many": 500}
    vehicle.advance(1.0)
    vehicle.receive(b"1002 0 0\0", vehicle.addresses.recipient, vehicle.addresses.modules[0])
    assert not vehicle.modules[0].power[0]


def test_telemetry_goes_where_the_programs_are_reported() -> None:
    vehicle = vehicle_of()
    sensors, module = vehicle.addresses.sensors[0], vehicle.addresses.modules[1]
    here = vehicle.addresses.recipient
    vehicle.receive(b"10001 50 3000\0", here, sensors)  # one more recipient
    vehicle.receive(b"10002 201 2970\0", here, module)  # another one, as in the thesis's example
    vehicle.receive(b"10001 0\0", here, vehicle.addresses.modules[2])  # none
    sent = vehicle.advance(0.05)
    to = {end: [packet.to for packet in sent if packet.source == end] for end in (sensors, module)}
    assert to[sensors] == [("127.0.0.100", 2969), ("127.0.0.50", 3000)]
    assert to[module] == [("127.0.0.201", 2970)]
    assert not any(packet.source == vehicle.addresses.modules[2] for packet in sent)
    vehicle.receive(b"10002 100 2969\0", here, sensors)  # here it means: one recipient less
    assert {p.to for p in vehicle.advance(0.15) if p.source == sensors} == {("127.0.0.50", 3000)}


def test_a_lower_motor_speed_turns_the_jet_more_slowly() -> None:
    angles = []
    for rpm in (7000, 1000):
        vehicle = vehicle_of(Conduct(timeout=math.inf))
        for text in ("1002 1 1", "1003 1 1", f"1005 {rpm}", "1004 1 247706"):
            vehicle.receive(text.encode(), vehicle.addresses.recipient, vehicle.addresses.modules[0])
        vehicle.advance(0.5)
        angles.append(float(vehicle.state[0, ACTUATORS]))
    nominal = vehicle.boat.thrusters[0].azimuth_rate
    assert angles[0] == pytest.approx(0.5 * nominal, rel=0.02)
    assert angles[1] == pytest.approx(0.5 * 1000 / 60 / 118 * 2 * math.pi, rel=0.02)


def test_a_flood_does_not_keep_a_vehicle_from_sailing() -> None:
    class Flooded:
        """A socket at which a datagram always waits."""

        def recvfrom(self, size: int) -> tuple[bytes, tuple[str, int]]:
            return b"junk", ("127.0.0.100", 2969)

    vehicle = vehicle_of()
    receive(vehicle, Flooded(), vehicle.addresses.modules[0])  # type: ignore[arg-type]
    assert vehicle.ignored["malformed"] == AT_ONCE


def test_packets_from_elsewhere_do_not_hold_a_link_up() -> None:
    with socket_link(own_network()) as link, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.0.0.1", 0))
        for _ in range(20):
            stranger.sendto(b"junk", link._socket.getsockname())
        assert link.receive(0.0) is None
        assert link.foreign == 1
