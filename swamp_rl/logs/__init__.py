"""Logs of other recorders: their tables and messages as runs, by a mapping of their fields to our columns."""
