"""The simulator: a boat's parameters, its state, and the compiled step that advances one boat or many."""

from swamp_rl.simulator.parameters import initial_state, parameters, tank
from swamp_rl.simulator.step import simulate, step, step_boat, step_parallel

__all__ = ["initial_state", "parameters", "simulate", "step", "step_boat", "step_parallel", "tank"]
