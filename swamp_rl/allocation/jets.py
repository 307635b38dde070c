"""What thrust allocation has to know of a boat's jets: where they stand, how hard and which way they push."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.allocation.throttle import throttle_for
from swamp_rl.boat import Boat, Thruster
from swamp_rl.errors import UserError
from swamp_rl.physics.thrusters import effective_thrust
from swamp_rl.simulator import parameters

Array = NDArray[np.float64]
Forbidden = Mapping[str, Sequence[tuple[float, float]]]


@dataclass(frozen=True)
class Jets:
    """K jets in the order of the boat file, failed ones included.

    x, y: (K,) places [m]; thrust_max, astern_max: (K,) [N], as it acts on the boat, the second 0 where a jet
    does not reverse; thrust_min: (K,) [N] that a working jet never falls below; azimuth_min, azimuth_max
    [rad], azimuth_rate [rad/s], offset [rad] between the azimuth and the force: (K,); forbidden: K tuples of
    azimuth sectors (from, to) [rad], clockwise, into which a jet must not push; works: (K,).
    """

    names: tuple[str, ...]
    x: Array
    y: Array
    thrust_max: Array
    astern_max: Array
    thrust_min: Array
    azimuth_min: Array
    azimuth_max: Array
    azimuth_rate: Array
    offset: Array
    forbidden: tuple[tuple[tuple[float, float], ...], ...]
    works: NDArray[np.bool_]
    record: NDArray[Any]

    @property
    def geometry(self) -> Array:
        """B (3, 2K): surge, sway force and yaw moment of X_1, Y_1, X_2, ... (5.40, with y to starboard)."""
        B = np.zeros((3, 2 * len(self.names)))
        B[0, 0::2] = B[1, 1::2] = 1.0
        B[2, 0::2], B[2, 1::2] = -self.y, self.x
        return B

    @property
    def lever(self) -> float:
        """Distance [m] from midship to the farthest jet, by which a moment is set against a force."""
        return float(np.hypot(self.x, self.y).max()) or 1.0

    def without(self, failed: Collection[str]) -> "Jets":
        """The same jets when those named push no more; UserError for a name that the boat does not have."""
        _refuse_strangers(failed, self.names, "failed thruster")
        return replace(self, works=self.works & ~np.isin(self.names, list(failed)))

    def throttles(self, thrust: Array) -> Array:
        """(K,) throttles [1] that give these thrusts [N], negative ones astern."""
        record = self.record[0]
        return np.array([throttle_for(float(thrust[k]), k, record) for k in range(len(self.names))])


def jets_of(
    boat: Boat,
    failed: Collection[str] = (),
    forbidden: Forbidden | None = None,
    thrust_min: float = 0.0,
    azimuth_rate: float | None = None,
) -> Jets:
    """The boat's jets with its own effects, less those that failed.

    forbidden: sectors by thruster name; thrust_min [N] of every working jet; azimuth_rate [rad/s]: a limit
    below the motors' own. UserError for a propeller with its rudder: its force hangs on the boat's speed.
    """
    for thruster in boat.thrusters:
        if not isinstance(thruster, Thruster):
            raise UserError(
                f"boat {boat.name}: thrusters.{thruster.name} is a propeller with its rudder, whose force "
                "hangs on the boat's speed; this needs jets (kind azimuth or fixed)"
            )
    names = boat.thruster_names
    _refuse_strangers(forbidden or {}, names, "forbidden sector of thruster")
    record = parameters(boat)
    one = record[0]
    count = len(names)
    ahead = np.array([effective_thrust(1.0, k, one) for k in range(count)])
    astern = np.array([-effective_thrust(-1.0, k, one) for k in range(count)])
    rate = (
        np.array(one["azimuth_rate"])
        if azimuth_rate is None
        else np.minimum(one["azimuth_rate"], azimuth_rate)
    )
    if not 0.0 <= thrust_min <= ahead.min():
        raise UserError(
            f"thrust_min {thrust_min:g} N must lie in [0, {ahead.min():.3g}], the weakest jet's most"
        )
    sectors = tuple(tuple((float(a), float(b)) for a, b in (forbidden or {}).get(name, ())) for name in names)
    jets = Jets(
        names,
        np.array(one["thruster_x"]),
        np.array(one["thruster_y"]),
        ahead,
        astern,
        np.full(count, thrust_min),
        np.array(one["azimuth_min"]),
        np.array(one["azimuth_max"]),
        rate,
        np.array(one["azimuth_offset"]),
        sectors,
        (ahead > 0.0) | (astern > 0.0),
        record,
    )
    return jets.without(failed)


def _refuse_strangers(given: Collection[str], names: Sequence[str], what: str) -> None:
    for name in given:
        if name not in names:
            raise UserError(f"{what} {name!r}: the boat has {', '.join(names)}; name one of these")
