"""Replay the commands of a recorded run through the simulator."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from swamp_rl.simulator.parameters import initial_state, parameters, tank
from swamp_rl.simulator.state import ACTUATORS, HEADING, SURGE, YAW_RATE
from swamp_rl.simulator.step import simulate

LONGEST_SUBSTEP = 0.05  # s; half of the 10 Hz control step, see docs/physics.md for the error it makes
