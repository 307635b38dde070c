"""How far a boat still has to go: the potential whose decrease rewards a learner."""

import math
from typing import Any

from swamp_rl.course.tables import GATE_COS, GATE_EAST, GATE_HALF_WIDTH, GATE_NORTH, GATE_SIN
from swamp_rl.physics.compile import compiled

ACROSS = 1.5
"""What a metre across the gate's direction counts: above 1, the steepest way first lines up with the gate."""

BERTH = 1.5
"""Clear of the buoys [m], on the way back round a gate that was missed."""


@compiled
def distance_to_gate(north: float, east: float, gate: Any) -> float:
    """Length [m] of the shortest way to the middle of the gate from its near side.

    gate: a row of `gate_table`. Lengths across the gate's direction count `ACROSS` times. From beyond the
    gate the way leads round the nearer end of the line through the buoys, `BERTH` outside of the buoy,
    never back between them: a boat is drawn to the side from which a crossing counts.
    """
    to_north, to_east = north - gate[GATE_NORTH], east - gate[GATE_EAST]
    along = to_north * gate[GATE_COS] + to_east * gate[GATE_SIN]
    across = abs(to_east * gate[GATE_COS] - to_north * gate[GATE_SIN])
    end = 0.0 if along < 0.0 else gate[GATE_HALF_WIDTH] + BERTH
    aside = ACROSS * (across - end)
    return math.sqrt(along * along + aside * aside) + ACROSS * end


@compiled
def distance_to_go(north: float, east: float, passed: int, gates: Any) -> float:
    """Length [m] of the way through all the gates that are left; nought once `passed` counts them all.

    It depends on the place and on the gates passed only, so its decreases along a run add up to its
    decrease from the first instant to the last, whatever the way. gates: `gate_table`.
    """
    if passed >= gates.shape[0]:
        return 0.0
    total = distance_to_gate(north, east, gates[passed])
    for i in range(passed + 1, gates.shape[0]):
        total += distance_to_gate(gates[i - 1, GATE_NORTH], gates[i - 1, GATE_EAST], gates[i])
    return total
