"""Limits that several effects share."""

RADIANS = "radians, up to one full turn"
LONGEST_DELAY = 2.0  # s, so that who steps a boat knows how many past commands to keep
MOST_DRIFT = 0.1  # s/s
