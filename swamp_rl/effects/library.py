"""The library: every effect there is, one call each. Names and units are the project's vocabulary."""

import math

from swamp_rl.effects.declare import FULL_TURN, Parameter, declare

RADIANS = "radians, up to one full turn"

declare(
    "current",
    Parameter("north", "m/s", 0.0, "current_north"),
    Parameter("east", "m/s", 0.0, "current_east"),
    acts_on="force",
    combine="add",
    description="the water moves, uniformly and steadily, towards north and east",
    source="thesis 7.3.3 and 8.1.3",
)

declare(
    "wind",
    Parameter("speed", "m/s", 0.0, "wind_speed", low=0.0, required=True),
    Parameter("from", "rad", 0.0, "wind_from", low=-FULL_TURN, high=FULL_TURN, limit=RADIANS, required=True),
    acts_on="force",
    combine="replace",
    description="mean wind at the boat and the direction it comes from, clockwise from north",
    source="thesis 8.17 to 8.19",
)

declare(
    "gusts",
    Parameter("speed_std", "m/s", 0.0, "gust_speed_std", low=0.0),
    Parameter("direction_std", "rad", 0.0, "gust_direction_std", low=0.0, high=math.pi, limit="radians"),
    Parameter("time_constant", "s", 5.0, "gust_time_constant", low=0.0, above_low=True),
    acts_on="force",
    combine="replace",
    description="Ornstein-Uhlenbeck gusts about the mean wind, on its speed and on its direction",
    source="thesis 7.3.3 names gusts; the process and its numbers are ours",
)

declare(
    "shallow_water",
    Parameter(
        "depth_over_draught",
        "1",
        9.0,
        "depth_over_draught",
        low=1.5,
        limit="the towing-tank tests end at 1.5; 9 and more is deep water",
        required=True,
    ),
    acts_on="force",
    combine="replace",
    description="resistance in water of that depth, from the towing tank",
    source="thesis table 4.7",
)

declare(
    "thruster_gain",
    Parameter("gain", "1", 1.0, "thruster_gain", low=0.0, required=True),
    acts_on="actuator",
    combine="multiply",
    description="a thruster pushes with that multiple of its thrust",
    source="ours: weed in an intake, a worn pump",
    thruster=True,
)

declare(
    "azimuth_lag",
    Parameter("time_constant", "s", None, "azimuth_time_constant", low=0.0),
    acts_on="actuator",
    combine="replace",
    description="time constant of every azimuth motor",
    source="thesis 5.7.1",
)

declare(
    "thruster_kick",
    Parameter("time", "s", 0.0, "kick_time", low=0.0, required=True),
    Parameter("duration", "s", 0.0, "kick_duration", low=0.0, required=True),
    Parameter("throttle", "1", 0.0, "kick_throttle", low=-1.0, high=1.0, required=True),
    Parameter(
        "azimuth", "rad", 0.0, "kick_azimuth", low=-FULL_TURN, high=FULL_TURN, limit=RADIANS, required=True
    ),
    acts_on="command",
    combine="replace",
    description="someone else commands the thruster for a while, whatever the pilot asks of it",
    source="thesis 7.3.3: an operator moved the stern thrusters with a joypad to disturb the run",
    thruster=True,
)

declare(
    "mass",
    Parameter("mass", "kg", None, "mass", low=0.0, above_low=True),
    acts_on="force",
    combine="replace",
    description="the boat's mass with its payload",
    source="thesis 4.2.1 and 8.1.3",
)

declare(
    "external_force",
    Parameter("north", "N", 0.0, "external_force_north"),
    Parameter("east", "N", 0.0, "external_force_east"),
    acts_on="force",
    combine="add",
    description="a steady push at midship in a direction fixed to the earth",
    source="ours: a towed line, a snag",
)
