"""A diagnosis with what it was reached from, for its report."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.conclude import Search
from swamp_rl.criticism.data import Trials
from swamp_rl.criticism.ladder import Ladder
from swamp_rl.criticism.leftover import Forces
from swamp_rl.criticism.result import Diagnosis

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Finding:
    """A diagnosis with what it was reached from."""

    diagnosis: Diagnosis
    trials: Trials
    weight: Array
    ladder: Ladder
    search: Search
    forces: Forces
