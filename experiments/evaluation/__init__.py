"""Pilots evaluated in the same episodes and compared."""
