"""A diagnosis with the data and fits that it is based on, for its report."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.inference.force_extension import ForceExtension
from swamp_rl.criticism.inference.next_trial import Designed
from swamp_rl.criticism.likelihood.output_error import Fit
from swamp_rl.criticism.model.candidates import Hypothesis, joined
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.criticism.selection.backward_elimination import Selection
from swamp_rl.criticism.selection.continuation import Continuation

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Finding:
    """A diagnosis with the data and fits that it is based on; written: the fit that goes into files;
    extension: the missing force, which goes there where it is `written`; next_trial: where one was designed.
    """

    diagnosis: Diagnosis
    run_set: RunSet
    weight: Array
    continuation: Continuation
    selection: Selection
    written: Fit
    extension: ForceExtension | None = None
    next_trial: Designed | None = None

    @property
    def extended_fit(self) -> Fit:
        """The fit of what the files hold: the written effects, and the missing force where written."""
        return self.extension.fit if self.extension and self.extension.result.written else self.written

    @property
    def extended(self) -> bool:
        """Whether anything was added to the boat file."""
        return bool(self.extended_fit.hypothesis.instances)

    @property
    def written_effects(self) -> tuple[Hypothesis, Array]:
        """The named effects that go into files, and their parameters (p,)."""
        return joined((one, x) for one, x in self.extended_fit.parts() if not one.curve)

    @property
    def written_curves(self) -> list[dict[str, Any]]:
        """The missing force as entries of the extended boat; none where it is not written."""
        return self.extension.entries if self.extension and self.extension.result.written else []
