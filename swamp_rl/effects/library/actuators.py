"""What differs in the thrusters and in how they obey."""

import math

from swamp_rl.effects.declare import FULL_TURN, Parameter, declare
from swamp_rl.effects.limits import LONGEST_DELAY, RADIANS
from swamp_rl.effects.search import Search

LAG = Search(0.223, 0.0, 4.47, (0.447, 1.34), "time")
EFFICIENCY = Search(0.2, 0.0, 2.5, (0.9,))
DEDUCTION = Search(0.15, 0.05, 1.5)
INDUCED = Search(0.15, 0.0, 0.6)  # 3.6 C_B B/L, which is 0.6 where that is 0.17 (Yoshimura, Masumoto 2012)
INDUCED_AT = Search(0.05, -0.5, -0.3)  # -0.464 for a tanker (Yasukawa and Yoshimura 2015), mostly -0.4

declare(
    "thruster_gain",
    Parameter(
        "gain", "1", 1.0, "thruster_gain", low=0.0, required=True, search=Search(0.2, 0.0, 2.5, (0.8,))
    ),
    acts_on="actuator",
    combine="multiply",
    description="a thruster pushes with that multiple of its thrust",
    source="ours: weed in an intake, a worn pump",
    thruster=True,
    alone_equals="thrust_scale",
    sudden=True,
)

declare(
    "thruster_failure",
    Parameter(
        "time",
        "s",
        math.inf,
        "failure_time",
        low=0.0,
        required=True,
        search=Search(0.0625, 0.0, 1.0, (), "run", step=0.0025),
    ),
    acts_on="actuator",
    combine="replace",
    description="a thruster that gives no thrust from that time on",
    source="ours: a fuse, a blocked intake",
    thruster=True,
    begin="changepoint",
    steady=False,
    sudden=True,
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
    begin=None,
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
        search=Search(0.1, -1.6, 1.6, (0.0,)),
    ),
    acts_on="actuator",
    combine="add",
    description="the jet points that much to starboard of where the azimuth motor believes it does",
    source="thesis 5.5.2: an error of homing",
    thruster=True,
    all_together=True,
)

declare(
    "azimuth_lag",
    Parameter(
        "time_constant",
        "s",
        None,
        "azimuth_time_constant",
        low=0.0,
        search=LAG,
    ),
    acts_on="actuator",
    combine="replace",
    description="time constant of every azimuth motor",
    source="thesis 5.7.1",
    moves_actuators=True,
    steady=False,
)

declare(
    "pump_lag",
    Parameter(
        "time_constant",
        "s",
        None,
        "pump_time_constant",
        low=0.0,
        search=LAG,
    ),
    acts_on="actuator",
    combine="replace",
    description="time constant of every pump motor",
    source="thesis 5.7.1",
    moves_actuators=True,
    steady=False,
)

declare(
    "command_delay",
    Parameter(
        "delay",
        "s",
        0.0,
        "command_delay",
        low=0.0,
        high=LONGEST_DELAY,
        search=Search(0.223, 0.0, 2.235, (0.279, 0.782), "time", step=0.0223),
    ),
    acts_on="command",
    combine="replace",
    description="commands reach the thrusters late",
    source="ours: radio and field bus",
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
    "azimuth_reversed",
    acts_on="command",
    combine="replace",
    description="a thruster or rudder turns to the other side of what it is commanded",
    source="ours: another sign convention of the log, a servo mounted upside down",
    thruster=True,
    reverses="azimuth_sign",
    needs="azimuth",
    all_together=True,
)

declare(
    "throttle_reversed",
    acts_on="command",
    combine="replace",
    description="a thruster pushes the other way than it is commanded",
    source="ours: another sign convention of the log, a motor wired the other way round",
    thruster=True,
    reverses="throttle_sign",
    needs="astern",
    all_together=True,
)

declare(
    "throttle_dead_band",
    Parameter(
        "below",
        "1",
        0.0,
        "dead_band",
        low=0.0,
        high=0.9,
        required=True,
        search=Search(0.1, 0.0, 0.9, (0.1, 0.3)),
    ),
    acts_on="actuator",
    combine="replace",
    description="no thrust below that share of the greatest command; beyond it the thrust rises from zero, "
    "to what it is without the dead band at full command",
    source="ArduPilot issues 7339 and 12381: motors that do not start below some throttle",
    thruster=True,
)

declare(
    "thruster_efficiency_curve",
    Parameter("at_30", "1", 1.0, "efficiency_30", low=0.0, search=EFFICIENCY),
    Parameter("at_60", "1", 1.0, "efficiency_60", low=0.0, search=EFFICIENCY),
    Parameter("at_100", "1", 1.0, "efficiency_100", low=0.0, search=EFFICIENCY),
    acts_on="actuator",
    combine="multiply",
    description="a thruster pushes with that multiple of its thrust at 30, 60 and 100 % of its greatest "
    "command: linear between them, constant below",
    source="ours: the bollard curve of a thruster departs from the boat file's in more than its size",
    thruster=True,
    contains=("thruster_gain",),
)

declare(
    "thrust_scale",
    Parameter("scale", "1", 1.0, "thrust_scale", low=0.0, search=Search(0.2, 0.1, 3.0, (0.9,))),
    acts_on="actuator",
    combine="multiply",
    description="all thrusters push with that multiple of their thrust",
    source="thesis 7.3.5: an uncertain thrust deduction",
    scope="day",
)

declare(
    "advance_thrust_loss",
    Parameter("factor", "1", 0.0, "advance_loss", search=Search(0.2, 0.0, 5.0, (0.3,))),
    acts_on="actuator",
    combine="add",
    description="thrust falls by that multiple of the water's speed along the jet over the jet's own",
    source="momentum of a jet; thesis 5.2",
)

declare(
    "crossflow_thrust_loss",
    Parameter("coefficient", "1", 0.0, "crossflow_loss", search=Search(5.0, 0.0, 250.0, (5.0, 25.0))),
    acts_on="actuator",
    combine="add",
    description="thrust falls by exp(-coefficient (V / V_o)^2), V: the flow across a jet of speed V_o",
    source="Typhoon AUV, eq. 24, on the ratio of speeds as the energy paper has it",
)

declare(
    "thrust_deduction",
    Parameter("low", "1", None, "deduction_factor_low", low=0.0, high=1.5, search=DEDUCTION),
    Parameter("high", "1", None, "deduction_factor_high", low=0.0, high=1.5, search=DEDUCTION),
    acts_on="actuator",
    combine="replace",
    description="share of the jets' thrust that is left at the boat file's low and high throttle, 1 - t",
    source="thesis 7.3.5: given by its ends only",
    contains=("thrust_scale",),
)

declare(
    "thrust_sag",
    Parameter("rate", "1/s", 0.0, "thrust_sag", search=Search(0.00179, 0.0, 0.0447, (0.00179,), "rate")),
    acts_on="actuator",
    combine="add",
    description="all thrust falls linearly from time 0, by that share a second",
    source="ours: a battery that runs down",
    scope="run",
    steady=False,
)

declare(
    "low_battery",
    Parameter("charge", "1", 1.0, "battery_charge", low=0.0, high=1.0, required=True),
    acts_on="actuator",
    combine="replace",
    description="every pack begins an episode at that state of charge: the thrust follows its voltage by the "
    "boat file's thrust_exponent, and is gone where the pack is empty",
    source="ours: a pack that was not charged",
    begin=None,  # thrust_scale, thrust_sag and thruster_failure are what a run shows of it
    battery=True,
)

declare(
    "rudder_hull_force",
    Parameter("a_h", "1", None, "rudder_a_h", low=0.0, search=INDUCED),
    Parameter("x_h", "1", None, "rudder_x_h", low=-1.0, high=1.0, search=INDUCED_AT),
    acts_on="force",
    combine="replace",
    description="the rudder's normal force induces a_h times as much sway force on the hull, x_h lengths "
    "forward of midship: Y = -(1 + a_h) F cos(angle), N = -(x_rudder + a_h x_h L) F cos(angle)",
    source="Yasukawa and Yoshimura, J Mar Sci Technol 20 (2015), 10.1007/s00773-014-0293-y: a_H, x'_H",
    thruster=True,
    needs="rudder",
    all_together=True,
)
