"""The library: every effect there is, one call each. Names and units are the project's vocabulary."""

import math

from swamp_rl.effects.declare import FULL_TURN, Parameter, declare

RADIANS = "radians, up to one full turn"
LONGEST_DELAY = 2.0  # s, so that who steps a boat knows how many past commands to keep

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

declare(
    "drifting_current",
    Parameter("north", "m/s", 0.0, "current_north"),
    Parameter("east", "m/s", 0.0, "current_east"),
    Parameter("north_rate", "m/s2", 0.0, "current_north_rate"),
    Parameter("east_rate", "m/s2", 0.0, "current_east_rate"),
    acts_on="force",
    combine="add",
    description="a current that changes linearly in time, from what it is at time 0",
    source="ours: a tide or a river that rises",
)

declare(
    "waves",
    Parameter("force", "N", 0.0, "wave_force", low=0.0, required=True),
    Parameter("frequency", "Hz", 0.0, "wave_frequency", low=0.0, required=True),
    Parameter("from", "rad", 0.0, "wave_from", low=-FULL_TURN, high=FULL_TURN, limit=RADIANS, required=True),
    Parameter("phase", "rad", 0.0, "wave_phase", low=-FULL_TURN, high=FULL_TURN, limit=RADIANS),
    acts_on="force",
    combine="replace",
    description="a push at midship that swings as a sine, away from where the waves come from when positive",
    source="ours: the first harmonic of a regular swell",
)

declare(
    "thruster_failure",
    Parameter("time", "s", math.inf, "failure_time", low=0.0, required=True),
    acts_on="actuator",
    combine="replace",
    description="a thruster that gives no thrust from that time on",
    source="ours: a fuse, a blocked intake",
    thruster=True,
)

declare(
    "azimuth_offset",
    Parameter(
        "offset",
        "rad",
        0.0,
        "azimuth_offset",
        low=-FULL_TURN,
        high=FULL_TURN,
        limit=RADIANS,
        required=True,
    ),
    acts_on="actuator",
    combine="add",
    description="the jet points that much to starboard of where the azimuth motor believes it does",
    source="thesis 5.5.2: an error of homing",
    thruster=True,
)

declare(
    "command_delay",
    Parameter("delay", "s", 0.0, "command_delay", low=0.0, high=LONGEST_DELAY),
    acts_on="command",
    combine="replace",
    description="commands reach the thrusters late",
    source="ours: radio and field bus",
)

declare(
    "pump_lag",
    Parameter("time_constant", "s", None, "pump_time_constant", low=0.0),
    acts_on="actuator",
    combine="replace",
    description="time constant of every pump motor",
    source="thesis 5.7.1",
)

declare(
    "channel_swap",
    acts_on="command",
    combine="replace",
    description="two thrusters obey each other's commands",
    source="ours: two plugs exchanged",
    swaps="channel",
)

declare(
    "thrust_scale",
    Parameter("scale", "1", 1.0, "thrust_scale", low=0.0),
    acts_on="actuator",
    combine="multiply",
    description="all thrusters push with that multiple of their thrust",
    source="thesis 7.3.5: an uncertain thrust deduction",
)

declare(
    "advance_thrust_loss",
    Parameter("factor", "1", 0.0, "advance_loss"),
    acts_on="actuator",
    combine="add",
    description="thrust falls by that multiple of the water's speed along the jet over the jet's own",
    source="momentum of a jet; thesis 5.2",
)

declare(
    "thrust_deduction",
    Parameter("low", "1", None, "deduction_factor_low", low=0.0, high=1.5),
    Parameter("high", "1", None, "deduction_factor_high", low=0.0, high=1.5),
    acts_on="actuator",
    combine="replace",
    description="share of the jets' thrust that is left at the boat file's low and high throttle, 1 - t",
    source="thesis 7.3.5: given by its ends only",
)

declare(
    "crossflow_thrust_loss",
    Parameter("coefficient", "1", 0.0, "crossflow_loss"),
    acts_on="actuator",
    combine="add",
    description="thrust falls by exp(-coefficient (V / V_o)^2), V: the flow across a jet of speed V_o",
    source="Typhoon AUV, eq. 24, on the ratio of speeds as the energy paper has it",
)

declare(
    "thrust_sag",
    Parameter("rate", "1/s", 0.0, "thrust_sag"),
    acts_on="actuator",
    combine="add",
    description="all thrust falls linearly from time 0, by that share a second",
    source="ours: a battery that runs down",
)

declare(
    "resistance",
    Parameter("scale", "1", 1.0, "resistance_scale", low=0.0),
    acts_on="force",
    combine="multiply",
    description="that multiple of the towing tank's resistance",
    source="ours: fouling, appendages, load",
)

declare(
    "linear_drag",
    Parameter("coefficient", "N s/m", 0.0, "linear_drag"),
    acts_on="force",
    combine="add",
    description="a surge resistance in proportion to the speed through the water",
    source="ours: what a square law leaves out at low speed",
)

declare(
    "centre_of_gravity",
    Parameter("x_g", "m", None, "x_g"),
    acts_on="force",
    combine="replace",
    description="centre of gravity, forward of midship",
    source="thesis 8.14: a payload that is not amidships",
)

declare(
    "yaw_inertia",
    Parameter("scale", "1", 1.0, "inertia_z", low=0.0, above_low=True),
    acts_on="force",
    combine="multiply",
    description="that multiple of the boat's own moment of inertia in yaw, without the water's",
    source="thesis 8.1.3 has it from CAD",
)

declare(
    "sway_drag",
    Parameter("scale", "1", 1.0, "c_d", low=0.0),
    acts_on="force",
    combine="multiply",
    description="that multiple of the cross-flow drag coefficient",
    source="thesis 8.1.3: a regression for other hulls",
)

declare(
    "yaw_damping",
    Parameter("scale", "1", 1.0, "n_r"),
    acts_on="force",
    combine="multiply",
    description="that multiple of N'_r",
    source="thesis 8.1.3: a regression for other hulls",
)

declare(
    "hull_coefficients",
    *(Parameter(name, "1", 1.0, name) for name in ("x_vr", "y_v", "y_r", "n_v", "n_r")),
    acts_on="force",
    combine="multiply",
    description="multiples of the linear hull derivatives",
    source="thesis 8.1.3: no real boat has exactly its regression's",
)

declare(
    "demihull_spacing",
    Parameter("spacing", "m", None, "hull_spacing", low=0.0),
    acts_on="force",
    combine="replace",
    description="two demihulls that far apart, each meeting its own surge speed: a moment that damps turns",
    source="thesis table 4.1; a catamaran's resistance acts on each hull",
)

declare(
    "hull_asymmetry",
    Parameter("yaw_moment", "N m s2/m2", 0.0, "asymmetry_yaw"),
    acts_on="force",
    combine="add",
    description="a yaw moment times surge times its magnitude, of hulls that are not alike",
    source="paper on SWAMP's identification: a bias to port",
)

declare(
    "heading_bias",
    Parameter("bias", "rad", 0.0, "heading_bias", low=-FULL_TURN, high=FULL_TURN, limit=RADIANS),
    acts_on="sensor",
    combine="add",
    description="the compass reads that much too far clockwise",
    source="ours: mounting, magnetic deviation",
)

declare(
    "position_delay",
    Parameter("delay", "s", 0.0, "position_delay", low=0.0, high=LONGEST_DELAY),
    acts_on="sensor",
    combine="replace",
    description="positions are stamped late",
    source="ours: a receiver's filter",
)

declare(
    "position_lever_arm",
    Parameter("x", "m", 0.0, "antenna_x"),
    Parameter("y", "m", 0.0, "antenna_y"),
    acts_on="sensor",
    combine="replace",
    description="the antenna stands that far forward and to starboard of midship",
    source="ours",
)
