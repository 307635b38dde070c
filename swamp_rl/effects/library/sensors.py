"""What the sensors report otherwise than it is."""

from swamp_rl.effects.declare import FULL_TURN, Parameter, declare
from swamp_rl.effects.limits import LONGEST_DELAY, MOST_DRIFT, RADIANS
from swamp_rl.effects.search import Search

LEVER = Search(0.161, -1.61, 1.61, (0.0,), "length")

declare(
    "heading_bias",
    Parameter(
        "bias",
        "rad",
        0.0,
        "heading_bias",
        low=-FULL_TURN,
        high=FULL_TURN,
        limit=RADIANS,
        search=Search(0.05, -1.5, 1.5, (0.0,)),
    ),
    acts_on="sensor",
    combine="add",
    description="the compass reads that much too far clockwise",
    source="ours: mounting, magnetic deviation",
    scope="day",
    sudden=True,
)

declare(
    "heading_drift",
    Parameter("rate", "rad/s", 0.0, "heading_drift", search=Search(0.0009, -0.045, 0.045, (0.0,), "rate")),
    acts_on="sensor",
    combine="add",
    description="the heading that is read turns clockwise at that rate from time 0",
    source="ours: a heading integrated from a rate gyro's bias",
)

declare(
    "gyro_bias",
    Parameter("bias", "rad/s", 0.0, "gyro_bias", search=Search(0.009, -0.45, 0.45, (0.0,), "rate")),
    acts_on="sensor",
    combine="add",
    description="the rate gyro reads that much too far clockwise",
    source="Farrell, Aided Navigation (2008): the bias of a rate gyro",
    sudden=True,
)

declare(
    "position_delay",
    Parameter(
        "delay",
        "s",
        0.0,
        "position_delay",
        low=0.0,
        high=LONGEST_DELAY,
        search=Search(0.223, 0.0, 2.235, (0.335,), "time", step=0.0223),
    ),
    acts_on="sensor",
    combine="replace",
    description="positions are stamped late",
    source="ours: a receiver's filter",
)

declare(
    "clock_offset",
    Parameter(
        "offset",
        "s",
        0.0,
        "clock_offset",
        low=-LONGEST_DELAY,
        high=LONGEST_DELAY,
        search=Search(0.223, -2.235, 2.235, (-0.335, 0.335), "time", step=0.0223),
    ),
    acts_on="sensor",
    combine="add",
    description="the receiver's clock is that much ahead of the commands': recorded positions, surge and "
    "sway come that late, or early; what arrives on board is not affected",
    source="ours: two recorders",
)

declare(
    "clock_drift",
    Parameter(
        "rate",
        "s/s",
        0.0,
        "clock_drift",
        low=-MOST_DRIFT,
        high=MOST_DRIFT,
        search=Search(0.179, -5.0, 5.0, (0.0,), "time_per_run", step=0.0179),
    ),
    acts_on="sensor",
    combine="add",
    description="the receiver's clock gains that much on the commands' in each second from time 0",
    source="ours: two recorders",
)

declare(
    "position_lever_arm",
    Parameter("x", "m", 0.0, "antenna_x", search=LEVER),
    Parameter("y", "m", 0.0, "antenna_y", search=LEVER),
    acts_on="sensor",
    combine="replace",
    description="the antenna stands that far forward and to starboard of midship",
    source="ours",
)
