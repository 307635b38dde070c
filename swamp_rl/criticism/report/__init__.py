"""The report that a person reads: the misfit first, then its name, then what it gains to add it."""

from swamp_rl.criticism.report.write import write_report

__all__ = ["write_report"]
