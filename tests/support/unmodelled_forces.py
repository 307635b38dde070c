"""Runs under forces that no effect of the library makes."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from swamp_rl.experiments.synthetic.cases import DT, Case, deviations, measure, voyages

from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.run_set import RunSet

SECTOR = {"what": "sector", "centre": 1.0, "force": 4.0}


DEAD_ZONE = {"what": "dead_zone", "thruster": "ss", "below": 0.55}


MOORING = {"what": "mooring", "length": 4.0, "stiffness": 2.0}


DROGUE = {"what": "drogue", "coefficient": 10.0}


BRAKE = {
    "effect": "force_curve",
    "component": "surge",
    "covariate": "surge",
    "formula": "square",
    "knots": [-5.0, 5.0],
    "values": [-10.0],
}


def sailed(
    outside: dict[str, Any] | None, level: str, seed: int = 1, effects: Sequence[dict[str, Any]] = ()
) -> RunSet:
    """Five runs of 80 s of every kind with the noise of a level."""
    rng = np.random.default_rng(seed)
    found = voyages(Case(level, "outside", list(effects), outside=outside), rng)
    noise = deviations(level)
    seen = np.stack([measure(one, noise, rng)[0] for one in found])
    seen[..., 2] = np.unwrap(seen[..., 2])
    seen[..., ~np.isfinite(noise)] = np.nan
    commands = np.stack([one.commands for one in found])
    lengths = np.full(len(found), seen.shape[1])
    return RunSet(load_boat("swamp"), DT, tuple("abcde"), commands, seen, lengths)
