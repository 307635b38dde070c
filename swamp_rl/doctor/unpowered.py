"""Boats that gather speed while all their thrusters are at rest: carried, pushed, or towed."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swamp_rl.doctor.finding import Finding
from swamp_rl.doctor.smooth import Motion

LEVELS = ("throttle_", "propeller_")
REST = 0.02
"""Of a level's largest size in all runs: a thruster below it is at rest."""
GAINED = 0.5
"""Of the median speed under commands: a gain of speed within a spell at rest that gusts and currents seldom
give. A boat that coasts loses speed, however slowly."""
SHORTEST = 5.0
"""s of such motion in a run, from which it is reported."""


def unpowered_findings(motions: Sequence[Motion]) -> list[Finding]:
    """A note with the runs in which the boat moves by GAINED faster than before in a spell at rest."""
    names = {name for one in motions for name in one.run.columns if name.startswith(LEVELS)}
    with_levels = [one for one in motions if names and names <= one.run.columns.keys()]
    most = {
        name: max(
            (float(np.abs(np.nan_to_num(one.run.columns[name])).max()) for one in with_levels), default=0.0
        )
        for name in names
    }
    resting = [_at_rest(one, most) for one in with_levels]
    under = [np.abs(one.velocity)[~rest] for one, rest in zip(with_levels, resting, strict=True)]
    usual = float(np.median(np.concatenate(under))) if any(len(one) for one in under) else 0.0
    places, first, longest = [], "", 0.0
    for one, rest in zip(with_levels, resting, strict=True):
        rows = np.flatnonzero(_gain(np.abs(one.velocity), rest) > GAINED * usual)
        seconds = len(rows) * one.step
        if usual == 0.0 or seconds < SHORTEST:
            continue
        first = first or f"{one.time[rows[0]]:.1f} to {one.time[rows[-1]]:.1f} s of {one.run.name}"
        longest = max(longest, seconds)
        places.append(one.run.name)
    if not places:
        return []
    message = f"are at rest while the boat gathers speed, first from {first}"
    advice = "if it was carried, pushed or towed, leave these rows out: --map keep=... in runs import"
    columns, figures = tuple(sorted(names)), {"seconds": longest}
    return [Finding("note", "unpowered", columns, message, advice, tuple(dict.fromkeys(places)), figures)]


def _at_rest(motion: Motion, most: dict[str, float]) -> NDArray[np.bool_]:
    """(T,) whether all levels are at rest, of the largest sizes `most`; a level without a number is."""
    levels = [np.nan_to_num(motion.run.columns[name]) for name in most]
    return np.all([np.abs(v) <= REST * most[n] for n, v in zip(most, levels, strict=True)], axis=0)


def _gain(speed: NDArray[np.float64], rest: NDArray[np.bool_]) -> NDArray[np.float64]:
    """(T,) speed above its least since the thrusters came to rest [m/s], 0 under commands."""
    gain = np.zeros(len(speed))
    edges = np.flatnonzero(np.diff(rest, prepend=False, append=False)).reshape(-1, 2).tolist()
    for begin, end in edges:
        spell = speed[begin:end]
        gain[begin:end] = spell - np.minimum.accumulate(spell)
    return gain
