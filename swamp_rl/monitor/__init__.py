"""Fault detection and isolation while a boat sails: innovations of a Kalman filter against its effects."""

from swamp_rl.monitor.monitor import Monitor, Notice

__all__ = ["Monitor", "Notice"]
