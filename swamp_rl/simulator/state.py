"""What one boat's state holds, as columns of a float64 array."""

# north, east [m], heading [rad, not wrapped], surge, sway [m/s over ground], yaw rate [rad/s],
# time [s], gust on the wind's speed [m/s] and direction [rad];
# then for K thrusters the K azimuths [rad] and the K throttles [1] that the actuators have reached.
NORTH, EAST, HEADING, SURGE, SWAY, YAW_RATE, TIME, GUST_SPEED, GUST_DIRECTION = range(9)
ACTUATORS = 9


def state_size(thrusters: int) -> int:
    """Columns of the state of a boat with that many thrusters."""
    return ACTUATORS + 2 * thrusters
