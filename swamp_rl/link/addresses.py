"""Where the thruster modules and the sensors' program of a vehicle are reached (thesis 6.2)."""

from dataclasses import dataclass
from ipaddress import AddressValueError, IPv4Address, IPv4Network, NetmaskValueError

from swamp_rl.errors import UserError
from swamp_rl.runs.thruster_telemetry import FIRST_MODULE

COMMAND_PORT, TELEMETRY_PORT = 2968, 2969
"""UDP ports at which the modules take commands, and to which telemetry goes by default."""
RECIPIENT, FIRST_COMPUTER = 100, 101
"""Last bytes of the default recipient of telemetry and of the (first) computational module."""
LOOPBACK = "127.0.0.0/24"
"""The thesis's network is 192.168.29.0/24; on one machine it becomes this."""
EXAMPLES = f"{LOOPBACK} (.201, .202, … as aboard) or 127.0.0.1:29680 (one address, ports from there)"

Endpoint = tuple[str, int]
"""An IPv4 address and a UDP port."""


@dataclass(frozen=True)
class Addresses:
    """Endpoints. `modules`: of the K thrusters, in the order of the boat file; `sensors`: where the
    sensors' program of each computational module takes commands; `recipient`: whom telemetry goes to unless
    somebody asks for it."""

    text: str
    network: IPv4Network
    modules: tuple[Endpoint, ...]
    sensors: tuple[Endpoint, ...]
    recipient: Endpoint

    def with_byte(self, byte: int) -> str:
        """The address in the network with that last byte; with one address for all, that one."""
        if self.network.prefixlen == 32:
            return str(self.network.network_address)
        return str(self.network.network_address + byte)

    def allows(self, address: str) -> bool:
        """Whether a datagram from there is the vehicle's business."""
        try:
            return IPv4Address(address) in self.network
        except AddressValueError:
            return False


def addresses(text: str, thrusters: int, computers: int = 1) -> Addresses:
    """The endpoints of a vehicle with that many thrusters from `A.B.C.0/24` or `A.B.C.D:PORT`.

    A network has the thesis's last bytes and ports: .201 and so on at 2968, .101 (and .102) and .100 at 2969.
    One address has the modules' ports from PORT on, then those of the sensors' programs, then the
    recipient's. UserError for any other text.
    """
    try:
        if "/" in text:
            return _network(text, IPv4Network(text), thrusters, computers)
        host, _, port = text.partition(":")
        return _one(text, IPv4Address(host), int(port), thrusters, computers)
    except (AddressValueError, NetmaskValueError, ValueError) as error:
        raise UserError(f"{text}: is not the address of a vehicle; give one such as {EXAMPLES}") from error


def _network(text: str, network: IPv4Network, thrusters: int, computers: int) -> Addresses:
    if network.prefixlen != 24 or FIRST_MODULE + thrusters > 255:
        raise ValueError(text)
    base = network.network_address
    modules = tuple((str(base + FIRST_MODULE + k), COMMAND_PORT) for k in range(thrusters))
    sensors = tuple((str(base + FIRST_COMPUTER + k), TELEMETRY_PORT) for k in range(computers))
    return Addresses(text, network, modules, sensors, (str(base + RECIPIENT), TELEMETRY_PORT))


def _one(text: str, host: IPv4Address, port: int, thrusters: int, computers: int) -> Addresses:
    if not 1 <= port <= 65535 - thrusters - computers or host.is_unspecified or host.is_multicast:
        raise ValueError(text)
    ends = tuple((str(host), number) for number in range(port, port + thrusters + computers + 1))
    network = IPv4Network(f"{host}/32")
    return Addresses(text, network, ends[:thrusters], ends[thrusters:-1], ends[-1])
