"""What an identification found."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat_fit.boat_file import Fitted
from swamp_rl.boat_fit.fit import BoatFit
from swamp_rl.boat_fit.pieces import Split
from swamp_rl.boat_fit.recent_thrust import Gains, RecentErrors
from swamp_rl.boat_fit.run_flow import RunFlow
from swamp_rl.boat_fit.run_thrust import ThrustLevel, UnlikeRuns
from swamp_rl.boat_fit.wiring import Wiring
from swamp_rl.criticism.result import Predictors

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Identification:
    """An identified boat.

    start, boat: before and after; fitted: its numbers; before, after: position errors on the held-out runs of
    the two files and of the trivial predictors; noise: (6,) of the sensors, NaN where there is none;
    unlike: runs of another thrust or of other commands, which the fit leaves out; alike: as `after`, on the
    held-out runs without these, none where all or no held-out runs are such; gains: of the thrust, from each
    run's own recent past, that predict the training runs best; recent: errors on the held-out runs with
    them, as `after` where they are none; recent_training: errors on the training runs by choice; level: of
    the thrust in the runs fitted to; weather: `wind` and `current` of these, fitted beside the numbers, each
    only where it is seen; in_current: as `alike`, each run in its own current.
    """

    start: Boat
    boat: Boat
    data: Split
    wiring: Wiring
    made: BoatFit
    fitted: tuple[Fitted, ...]
    before: list[Predictors]
    after: list[Predictors]
    noise: Array
    elapsed: float
    unlike: UnlikeRuns = field(default_factory=UnlikeRuns)
    alike: list[Predictors] = field(default_factory=list)
    gains: Gains = "none"
    recent: list[RecentErrors] = field(default_factory=list)
    recent_training: dict[Gains, list[RecentErrors]] = field(default_factory=dict)
    level: ThrustLevel = field(default_factory=ThrustLevel)
    weather: dict[str, list[RunFlow]] = field(default_factory=dict)
    in_current: list[RecentErrors] = field(default_factory=list)

    @property
    def predicted(self) -> list[Predictors]:
        """Errors on the held-out runs with the gains, and of the trivial predictors."""
        own = {one.horizon_s: one.position for one in self.recent}
        return [
            one.model_copy(update={"boat_file": own.get(one.horizon_s, np.nan)}) if own else one
            for one in self.after
        ]
