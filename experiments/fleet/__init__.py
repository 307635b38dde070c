"""Diagnoses of many boats at once, on one machine or many, and what they have in common."""

from swamp_rl.experiments.fleet.run import diagnose_fleet, members_of

__all__ = ["diagnose_fleet", "members_of"]
