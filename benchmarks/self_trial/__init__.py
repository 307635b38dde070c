"""Calibration of the self-trial of `swamp-rl diagnose`."""
