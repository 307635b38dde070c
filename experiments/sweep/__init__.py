"""Sweeps: one experiment tried with many values of its parameters, on one machine or many."""

from swamp_rl.experiments.sweep.run import run_sweep
from swamp_rl.experiments.sweep.schema import Sweep, load_sweep

__all__ = ["Sweep", "load_sweep", "run_sweep"]
