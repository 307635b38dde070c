"""The HTML report of a diagnosis: prediction error, causes, and the gain of adding them."""

from swamp_rl.criticism.report.page import write_report

__all__ = ["write_report"]
