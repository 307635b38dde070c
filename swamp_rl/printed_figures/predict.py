"""Printed figures of a boat with effects, in units of their errors."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.boat import Boat
from swamp_rl.boat.load import Chain, boat_of_chain
from swamp_rl.criticism.model.candidates import Hypothesis
from swamp_rl.criticism.options import options
from swamp_rl.effects import EffectEntry, apply_effects
from swamp_rl.errors import errors_at
from swamp_rl.printed_figures.manoeuvres import READERS, Loaded, Test
from swamp_rl.printed_figures.schema import Figure, FiguresFile, Load

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Fleet:
    """A boat at every load of a figures file, by mass [kg] and water density [kg/m³] as a figure has them."""

    nominal: Boat
    loaded: Mapping[tuple[float, float | None], Loaded]


def fleet_of(boat: Chain, found: FiguresFile) -> Fleet:
    """The boat of these files (`boat_chain`) at the loads that the figures ask for."""
    loads = {load.mass: load for load in found.loads}
    asked = dict.fromkeys((figure.mass, figure.water_density) for figure in found.figures)
    boats = {key: _loaded(boat, loads.get(key[0]), *key) for key in asked}
    return Fleet(boat_of_chain(boat), {key: Loaded(one) for key, one in boats.items()})


def _loaded(boat: Chain, load: Load | None, mass: float, density: float | None) -> Boat:
    """The boat with the load in that water; UserError where there is no such boat."""
    water = "" if density is None else f" in water of {density:g} kg/m3"
    with errors_at(f"the boat at {mass:g} kg{water}"):
        return boat_of_chain(boat, _replaced(load, density))


def _replaced(load: Load | None, density: float | None) -> dict[str, Any]:
    """The keys of the boat file that a load and the water replace."""
    given = {} if load is None else load.model_dump(exclude={"source"}, exclude_none=True)
    return given | ({} if density is None else {"water_density": density})


def predicted(fleet: Fleet, figures: Sequence[Figure], hypothesis: Hypothesis, x: Array) -> Array:
    """(n,) figures of the boat with a hypothesis's effects at x (p,); each test is simulated once."""
    entries = tuple(hypothesis.entries(x))
    records: dict[Any, NDArray[Any]] = {}
    for key in dict.fromkeys((figure.mass, figure.water_density) for figure in figures):
        at = fleet.loaded[key]
        records[key] = at.plain.copy()
        apply_effects(records[key], entries, at.boat.thruster_names)
    tests: dict[Any, Test] = {}
    values = []
    for figure in figures:
        if figure.test not in tests:
            key = figure.mass, figure.water_density
            tests[figure.test] = test_of(figure, fleet.loaded[key], entries, records[key])
        _, reader = READERS[figure.manoeuvre][figure.figure]
        values.append(reader(tests[figure.test]))
    return np.array(values, float)


def test_of(figure: Figure, at: Loaded, entries: tuple[EffectEntry, ...], record: NDArray[Any]) -> Test:
    """A figure's test of a boat with effects; record: (1,) of that boat."""
    if figure.depth_over_draught is not None:
        record = record.copy()
        record["depth_over_draught"] = figure.depth_over_draught
    return Test(
        at,
        entries,
        record,
        figure.throttle or 0.0,
        figure.thrusters,
        figure.speed or 0.0,
        math.radians(figure.angle_deg or 0.0),
    )


def misfits(figures: Sequence[Figure], values: Array) -> Array:
    """(n,) values less what is printed, in errors; 0 within a limit, `figure_far` where one is not finite."""
    printed, errors = np.array([(figure.value, figure.error) for figure in figures]).T
    off = (values - printed) / errors
    for limit, beyond in (("at_most", np.maximum), ("at_least", np.minimum)):
        limited = np.array([figure.limit == limit for figure in figures])
        off[limited] = beyond(off[limited], 0.0)
    return np.clip(np.nan_to_num(off, nan=options().figure_far), -options().figure_far, options().figure_far)
