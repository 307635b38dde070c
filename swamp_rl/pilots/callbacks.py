"""Callbacks of a training."""

from collections.abc import Callable, Mapping

Tick = Callable[[float], None]
"""Called with the share done, from 0 to 1."""

Log = Callable[[int, Mapping[str, float]], None]
"""Called with points of the learning curve: actions, epochs or rounds done, and the measured values."""
