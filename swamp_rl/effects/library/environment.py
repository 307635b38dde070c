"""What the water, the air and others do to the boat."""

import math

from swamp_rl.constants import FASTEST_AIR, FASTEST_WATER
from swamp_rl.effects.declare import FULL_TURN, Parameter, declare
from swamp_rl.effects.limits import RADIANS
from swamp_rl.effects.search import Search

STREAM = Search(0.072, -1.08, 1.08, (0.0,), "speed")
TREND = Search(0.00129, -0.0323, 0.0323, (0.0,), "acceleration")
SWELL = Search(0.041, -4.1, 4.1, (), "thrust")  # of the force towards south, and towards west
PUSH = Search(0.0205, -0.615, 0.615, (0.0,), "thrust")

declare(
    "current",
    Parameter("north", "m/s", 0.0, "current_north", -FASTEST_WATER, FASTEST_WATER, search=STREAM),
    Parameter("east", "m/s", 0.0, "current_east", -FASTEST_WATER, FASTEST_WATER, search=STREAM),
    acts_on="force",
    combine="add",
    description="the water moves, uniformly and steadily, towards north and east",
    source="thesis 7.3.3 and 8.1.3",
    weather=True,
    scope="run",
    sudden=True,
)

declare(
    "drifting_current",
    Parameter("north", "m/s", 0.0, "current_north", -FASTEST_WATER, FASTEST_WATER, search=STREAM),
    Parameter("east", "m/s", 0.0, "current_east", -FASTEST_WATER, FASTEST_WATER, search=STREAM),
    Parameter(
        "north_rate",
        "m/s2",
        0.0,
        "current_north_rate",
        search=TREND,
    ),
    Parameter(
        "east_rate",
        "m/s2",
        0.0,
        "current_east_rate",
        search=TREND,
    ),
    acts_on="force",
    combine="add",
    description="a current that changes linearly in time, from what it is at time 0",
    source="ours: a tide or a river that rises",
    weather=True,
    scope="run",
)

declare(
    "wind",
    Parameter(
        "speed",
        "m/s",
        0.0,
        "wind_speed",
        low=0.0,
        high=FASTEST_AIR,
        required=True,
        search=Search(1.44, -14.4, 14.4, (0.866, 2.17, 5.05), "speed"),
    ),
    Parameter(
        "from",
        "rad",
        0.0,
        "wind_from",
        low=-FULL_TURN,
        high=FULL_TURN,
        limit=RADIANS,
        required=True,
        search=Search(1.44, -14.4, 14.4, (), "speed"),
    ),
    acts_on="force",
    combine="replace",
    description="mean wind at the boat and the direction it comes from, clockwise from north",
    source="thesis 8.17 to 8.19",
    weather=True,
    scope="run",
    begin="grid",
    vector=("speed", "from"),
)

declare(
    "wind_coefficients",
    Parameter(
        "c_x",
        "1",
        None,
        "air_c_x",
        low=0.0,
        search=Search(0.2, 0.0, 5.0, prior=("wind.c_x", "wind.frontal_area")),
    ),
    Parameter(
        "c_y",
        "1",
        None,
        "air_c_y",
        low=0.0,
        search=Search(0.2, 0.0, 5.0, prior=("wind.c_y", "wind.lateral_area")),
    ),
    Parameter(
        "lateral_centre",
        "m",
        None,
        "air_lateral_centre",
        search=Search(0.1, -0.5, 0.5, of="length", prior=("wind.lateral_centre",)),
    ),
    Parameter("c_n", "1", None, "air_c_n", search=Search(0.15, -0.5, 1.0, prior=("wind.c_n",))),
    acts_on="force",
    combine="replace",
    description="the wind's force coefficients, on the boat file's areas, and the lever of its sway force",
    source="thesis 8.17 to 8.19; a boat file from main dimensions has them by analogy",
    beside="wind",
)

declare(
    "gusts",
    Parameter("speed_std", "m/s", 0.0, "gust_speed_std", low=0.0, high=FASTEST_AIR),
    Parameter("direction_std", "rad", 0.0, "gust_direction_std", low=0.0, high=math.pi, limit="radians"),
    Parameter("time_constant", "s", 5.0, "gust_time_constant", low=0.0, above_low=True),
    acts_on="force",
    combine="replace",
    description="Ornstein-Uhlenbeck gusts about the mean wind, on its speed and on its direction",
    source="thesis 7.3.3 names gusts; the process and its numbers are ours",
    weather=True,
    begin=None,
)

declare(
    "waves",
    Parameter("force", "N", 0.0, "wave_force", low=0.0, required=True, search=SWELL),
    Parameter(
        "frequency",
        "Hz",
        0.0,
        "wave_frequency",
        low=0.0,
        required=True,
        search=Search(0.0179, 0.00895, 2.68, (), "rate"),
    ),
    Parameter(
        "from",
        "rad",
        0.0,
        "wave_from",
        low=-FULL_TURN,
        high=FULL_TURN,
        limit=RADIANS,
        required=True,
        search=SWELL,
    ),
    Parameter(
        "phase",
        "rad",
        0.0,
        "wave_phase",
        low=-FULL_TURN,
        high=FULL_TURN,
        limit=RADIANS,
        search=Search(0.5, -math.inf, math.inf),
    ),
    acts_on="force",
    combine="replace",
    description="a push at midship that swings as a sine, away from where the waves come from when positive",
    source="ours: the first harmonic of a regular swell",
    weather=True,
    scope="run",
    begin="spectral",
    vector=("force", "from"),
    half_turn=("from", "phase"),
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
        search=Search(1.0, 1.5, 9.0, (1.8, 3.0)),
    ),
    acts_on="force",
    combine="replace",
    description="resistance in water of that depth, from the towing tank",
    source="thesis table 4.7",
    weather=True,
    scope="run",
)

declare(
    "external_force",
    Parameter("north", "N", 0.0, "external_force_north", search=PUSH),
    Parameter("east", "N", 0.0, "external_force_east", search=PUSH),
    acts_on="force",
    combine="add",
    description="a steady push at midship in a direction fixed to the earth",
    source="ours: a towed line, a snag",
    weather=True,
    scope="run",
    sudden=True,
)
