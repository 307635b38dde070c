"""The command line: a file for each verb or group of verbs."""

from swamp_rl.experiments.cli.app import main

__all__ = ["main"]
