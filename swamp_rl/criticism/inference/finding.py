"""A diagnosis with the data and fits that it is based on, for its report."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.residual_force import Forces
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.continuation import Continuation

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Finding:
    """A diagnosis with the data and fits that it is based on; written: the fit that goes into files."""

    diagnosis: Diagnosis
    run_set: RunSet
    weight: Array
    continuation: Continuation
    selection: Selection
    forces: Forces
    written: Fit
