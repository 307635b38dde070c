"""Progress of a diagnosis as records of `logging`: INFO for each stage, DEBUG for each fit."""

import logging

LOG = logging.getLogger("swamp_rl.criticism")
