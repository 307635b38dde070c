"""What a training reports to while it runs."""

from collections.abc import Callable, Mapping

Tick = Callable[[float], None]
"""Told how much of the stage's total is done so far."""

Log = Callable[[int, Mapping[str, float]], None]
"""Told points of the learning curve: decisions, epochs or rounds done, and what was measured then."""
