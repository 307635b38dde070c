"""Wind and current as they are drawn beside the boats: an arrow with its speed, once for one weather."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from swamp_rl.demo.clock import Array
from swamp_rl.demo.colours import Colour
from swamp_rl.demo.scene import DemoScene, Shown
from swamp_rl.demo.series import current, wind
from swamp_rl.runs import Run

FLOWS = {"wind": wind, "current": current}
INK: dict[str, Colour] = {"wind": (84, 106, 125), "current": (31, 143, 208)}


@dataclass(frozen=True)
class Flow:
    """name: `wind` or `current`; whose: the boat it is at, empty where there is no doubt; towards: (N, 2)
    north and east [m/s] at each time."""

    name: str
    whose: str
    towards: Array


def flows_of(run: Run) -> dict[str, Array]:
    """(T, 2) north and east [m/s] by name, those recorded or set; a recorder writes 0 where none is known."""
    every = {name: measured(run) for name, measured in FLOWS.items()}
    return {name: flow for name, flow in every.items() if flow is not None and np.any(np.nan_to_num(flow))}


def flows(scene: DemoScene, shown: Sequence[Shown], times: Array) -> list[Flow]:
    """What the boats `shown` meet at `times` (N,) of the clock; nothing where there are too many to tell."""
    if not scene.few:
        return []
    found = []
    for item in shown:
        for name, flow in flows_of(item.run).items():
            own = item.start + item.run.time - item.run.time[0]
            towards = np.stack([np.interp(times, own, column) for column in flow.T], axis=-1)
            found.append(Flow(name, scene.called(item) if len(shown) > 1 else "", towards))
    if not scene.conditions.same:
        return found
    # The first that tells a flow tells it for all.
    once = {flow.name: flow for flow in reversed(found)}
    return [Flow(name, "", once[name].towards) for name in FLOWS if name in once]
