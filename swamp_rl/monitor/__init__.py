"""Fault detection and isolation while a boat sails: innovations of a Kalman filter against its effects."""

from swamp_rl.monitor.monitor import Monitor, Notice
from swamp_rl.monitor.sample import Sample, samples_of

__all__ = ["Monitor", "Notice", "Sample", "samples_of"]
