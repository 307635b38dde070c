"""What a step is worth: way made good and gates passed, less the levers' use, the time and a failure."""

from swamp_rl.physics.compile import compiled

PROGRESS = 0.1  # for each metre by which the distance to go has decreased
GATE = 1.0  # for each gate passed
FAILURE = 2.0  # for touching a buoy or leaving the bounds, once
EFFORT = 0.01  # for each second at full throttle
TIME = 0.02  # for each second under way, so that waiting costs more than it puts off
CHANGE = 0.002  # for each second in which a lever moves over its unit range once a second


@compiled
def reward(
    way_made: float,
    gates: int,
    failed: bool,
    throttle: float,
    throttle_rate: float,
    angle_rate: float,
    dt: float,
) -> float:
    """Reward of a step of dt [s].

    way_made: decrease of `distance_to_go` [m], so that over a run only its ends count (Ng, Harada and Russell
    1999, with no discount); gates: passed in this step; throttle: of the step [1]; throttle_rate,
    angle_rate: changes of the levers since the step before, by dt [1/s]. Effort and change are integrals
    over time of squares, so that they mean the same at any step.
    """
    effort = EFFORT * throttle * throttle
    change = CHANGE * (throttle_rate * throttle_rate + angle_rate * angle_rate)
    return PROGRESS * way_made + GATE * gates - (effort + change + TIME) * dt - (FAILURE if failed else 0.0)
