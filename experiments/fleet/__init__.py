"""Diagnoses of many boats at once, on one machine or many, and what they have in common."""

from swamp_rl.experiments.fleet.members import members_of
from swamp_rl.experiments.fleet.run import diagnose_fleet

__all__ = ["diagnose_fleet", "members_of"]
