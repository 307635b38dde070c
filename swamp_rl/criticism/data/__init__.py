"""Measured runs: loading, checks, excitation, windows, measurement noise."""
