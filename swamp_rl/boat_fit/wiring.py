"""Search for commands that are stamped early or late, and for exchanged and sign-flipped command channels."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from swamp_rl.boat import Boat
from swamp_rl.boat_fit.command_offset import command_offset
from swamp_rl.boat_fit.fit import SHORT, fit_windows, soft_weights
from swamp_rl.boat_fit.hypothesis import Array, FreeBoat, free_boat
from swamp_rl.boat_fit.pieces import pieces
from swamp_rl.boat_fit.wiring_response import wiring_likelihoods
from swamp_rl.boat_numbers.number import Number
from swamp_rl.boat_numbers.numbers import free_numbers, without_compass
from swamp_rl.criticism.data.measurement_noise import weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.model.candidates import selectors
from swamp_rl.criticism.progress import LOG
from swamp_rl.criticism.threads import each
from swamp_rl.doctor.response import LIKELIER
from swamp_rl.effects import LIBRARY, Effect, EffectEntry
from swamp_rl.simulator import parameters

SECONDS = 120.0  # s of runs that the search fits to
LONG, STRETCH = 2.0, 30.0  # times SECONDS, beyond which runs are cut in stretches, and s of these
STEPS = 4  # Jacobians of each of its fits
LIKELY = 2  # wirings that are fitted in full, at most
FAR = 4.0  # times the chi2 without a change, up to which a wiring is
MOST_TOGETHER = 4  # changes of which every combination is tried; of more, one after the other
CLEARLY = 0.8  # of the chi2 without it, below which a change is taken
ADVANCE = 0.6  # s, by which commands that may be stamped late are tried earlier
DELAYS = (0.0, 0.5, 1.0)  # s, from which the delay of the commands is fitted
LAGS = 0.3  # s of an offset that the lags of actuators may be
REACHED = 0.2  # s of delay that a fit from none reaches: the prior width of the delay
LATE = 0.05  # s that commands must be stamped late to be corrected


@dataclass(frozen=True)
class Wiring:
    """What had to be changed in the commands. boat: with the effects that say it; changes: in words; advance
    [s]: by which the commands of the log were taken earlier.
    """

    boat: Boat
    changes: tuple[str, ...]
    advance: float
    x: Array


Change = tuple[str, EffectEntry]
SIGNS = {
    "azimuth_reversed": {"propeller_rudder": "rudder", "": "azimuth"},
    "throttle_reversed": {"propeller_rudder": "revolutions", "": "throttle"},
}


def possible_changes(boat: Boat) -> list[Change]:
    """Exchanged pairs of channels and channels of the other sign, on the thrusters that can show it."""
    return [
        (
            _words(effect, chosen, boat),
            EffectEntry(effect, (chosen[0], chosen[1]) if effect.swaps else chosen[0], {}),
        )
        for effect in LIBRARY.values()
        if effect.swaps or effect.reverses
        for chosen in selectors(effect, boat)
    ]


def _words(effect: Effect, chosen: Sequence[str], boat: Boat) -> str:
    if effect.swaps:
        return (
            f"{chosen[0]} and {chosen[1]} obey each other's commands, or each is at the other's place in the "
            "start file (x forward, y to starboard)"
        )
    named = SIGNS[effect.name]
    if chosen == ("all",):
        return f"the {named['']} commands of all thrusters have the other sign"
    kind = boat.thrusters[boat.thruster_names.index(chosen[0])].kind
    return f"the {named.get(kind, named[''])} of {chosen[0]} has the other sign"


def search_wiring(run_set: RunSet, noise: Array, positions: bool = False) -> Wiring:
    """The wiring that explains the runs best, and the numbers x that it was judged with.

    First the offset of the clocks by equation error, which no wiring moves. With none and with that one, of
    up to MOST_TOGETHER possible changes every combination is fitted, of more the best one change after
    another, but none that is far less likely than no change by equation error in all runs; then other delays
    of the commands, and commands taken earlier. noise: (6,) of the sensors.
    """
    part = replace(_some_runs(run_set), origin=())
    soft = soft_weights(weights(part, noise), run_set.boat)
    offset = command_offset(run_set)
    LOG.info("motion %.1f s after the commands by equation error", offset)
    trial = _Trial(part, soft, positions, whole=run_set, offset=offset)
    changes = possible_changes(run_set.boat)
    best = _best_combination if len(changes) <= MOST_TOGETHER else _one_by_one
    least, taken = best(trial, changes)
    delay, advance = _begin(offset)
    if delay > REACHED or advance > 0.0:
        late = replace(trial, delay=delay, advance=advance)
        found, others = best(late, changes)
        if found < CLEARLY * least:  # the motion of a boat under control has a period, and its half is a sign
            trial, taken = late, others
    return _timed(trial, taken, advance or ADVANCE)


def _timed(trial: "_Trial", taken: Sequence[Change], earlier: float) -> Wiring:
    """The wiring with the delay of the commands that explains the runs best, or with commands taken earlier.

    These are tried `earlier` [s] unless the motion follows the commands after more than lags of actuators may
    be. Where it precedes them, they are taken earlier unless that is clearly worse.
    """
    boat = rewired(trial.run_set.boat, taken)
    delays = [DELAYS[0], *sorted({*DELAYS[1:], trial.delay} - {DELAYS[0]})]
    may_be_late = trial.offset <= LAGS
    times = [*((delay, 0.0) for delay in delays), *[(ADVANCE, earlier)] * may_be_late]
    (chi2, x), *later = each(lambda one: trial.fitted(boat, *one), times)
    found, other = later.pop() if may_be_late else (math.inf, x)
    for chi2_later, x_later in later:
        chi2, x = (chi2_later, x_later) if chi2_later < CLEARLY * chi2 else (chi2, x)
    enough, advance = (1.0 / CLEARLY if trial.offset < 0.0 else CLEARLY), 0.0
    delay = float(other[trial.delay_column(boat)]) if np.isfinite(found) else earlier
    if found < enough * chi2 and earlier - delay > LATE:
        advance = round(earlier - delay, 2)
        x = other.copy()
        x[trial.delay_column(boat)] = 0.0
    return Wiring(boat, tuple(description for description, _ in taken), advance, x)


def _begin(offset: float) -> tuple[float, float]:
    """Delay and advance [s] that the search of the wiring begins with, of an offset of the clocks."""
    if offset < 0.0:
        return ADVANCE, round(ADVANCE - offset, 2)
    return max(0.0, round(offset - LAGS, 2)), 0.0


@dataclass
class _Trial:
    """Quick fits of differently wired boats to the same runs, by default from `delay` [s], the commands taken
    `advance` [s] earlier; made: those that are done. whole: all runs, whose motion follows the commands after
    `offset` [s].
    """

    run_set: RunSet
    weight: Array
    positions: bool
    whole: RunSet
    offset: float
    delay: float = 0.0
    advance: float = 0.0
    made: dict[tuple[bytes, float, float, int], tuple[float, Array]] = field(default_factory=dict)

    def hypothesis(self, boat: Boat) -> FreeBoat:
        return free_boat(boat, without_compass(free_numbers(boat, self.positions)))

    def delay_column(self, boat: Boat) -> int:
        names = [number.name for number in self.hypothesis(boat).numbers]
        return names.index("effects.command_delay.delay")

    def obeyed(self, boat: Boat) -> bytes:
        """The commands in the runs that each thruster of the boat obeys."""
        wired = parameters(boat)[0]
        angles, levels = np.split(self.run_set.commands, 2, axis=2)
        channel = wired["channel"].astype(int)
        signed = wired["azimuth_sign"] * angles[..., channel], wired["throttle_sign"] * levels[..., channel]
        return b"".join((part + 0.0).tobytes() for part in signed)  # without the sign of zero

    def fitted(
        self, boat: Boat, delay: float | None = None, advance: float | None = None, steps: int = STEPS
    ) -> tuple[float, Array]:
        """chi2 and numbers of a fit with so many Jacobians from that delay [s], the commands taken `advance`
        [s] earlier.
        """
        delay = self.delay if delay is None else delay
        advance = self.advance if advance is None else advance
        key = self.obeyed(boat), delay, advance, steps
        if key not in self.made:
            self.made[key] = self._fitted(boat, delay, advance, steps)
            LOG.debug("delay %g s, advance %g s, %d steps: chi2 %.0f", *key[1:], self.made[key][0])
        return self.made[key]

    def _fitted(self, boat: Boat, delay: float, advance: float, steps: int) -> tuple[float, Array]:
        hypothesis = self.hypothesis(boat)
        x = hypothesis.start()
        x[self.delay_column(boat)] += delay
        moved = advanced(replace(self.run_set, boat=boat), advance)
        _, made, chi2 = fit_windows(moved, self.weight, SHORT, hypothesis, (x,), steps)
        return chi2 if np.isfinite(chi2) else np.inf, made.x


def rewired(boat: Boat, changes: Sequence[Change]) -> Boat:
    """The boat with the changes among its effects."""
    if not changes:
        return boat
    return boat.model_copy(update={"effects": (*boat.effects, *(entry for _, entry in changes))})


def advanced(run_set: RunSet, seconds: float) -> RunSet:
    """The runs with their commands taken `seconds` earlier, held to a row; the last ones stay."""
    rows = round(seconds / run_set.dt)
    if rows == 0:
        return run_set
    last = run_set.commands.shape[1] - 1
    return replace(run_set, commands=run_set.commands[:, np.minimum(np.arange(last + 1) + rows, last)])


def less_advanced(wiring: Wiring, numbers: Sequence[Number], dt: float) -> Wiring:
    """The wiring with commands taken no earlier than the fit needs: a delay that it has added in whole rows
    takes as much of it back.
    """
    x, back = wiring.x.copy(), 0.0
    for column, number in enumerate(numbers):
        if number.field == "command_delay":
            added = min(float(x[column]) - number.start, wiring.advance)
            back = max(math.floor(added / dt + 1e-6) * dt, 0.0)
            x[column] -= back
    return replace(wiring, advance=round(wiring.advance - back, 2), x=x)


def _some_runs(run_set: RunSet) -> RunSet:
    """Runs of about SECONDS together, spread evenly over all; of long runs, stretches."""
    mean = float(run_set.lengths.mean()) * run_set.dt
    if mean > LONG * SECONDS:
        run_set = pieces(run_set, STRETCH)[0]
        mean = float(run_set.lengths.mean()) * run_set.dt
    count = min(len(run_set.lengths), max(1, round(SECONDS / mean)))
    return run_set.subset(sorted({int(i) for i in np.linspace(0, len(run_set.lengths) - 1, count).round()}))


def _best_combination(trial: _Trial, changes: list[Change]) -> tuple[float, list[Change]]:
    """chi2 and the changes of the best combination, none of them where it is not clearly better."""
    every = [list(some) for n in range(1, len(changes) + 1) for some in itertools.combinations(changes, n)]
    least = trial.fitted(trial.run_set.boat)[0]
    return _best_of(trial, [], every, least) or (least, [])


def _best_of(
    trial: _Trial, taken: list[Change], every: list[list[Change]], least: float
) -> tuple[float, list[Change]] | None:
    """chi2 and changes of the best of several wirings where it is clearly better than `taken`, of `least`.

    Of wirings by which the thrusters obey the same commands in these runs, such as an exchange of equal
    commands and none, the first is tried. Only the most likely ones by a shorter fit are fitted in full, and
    none that are far from `least` there, or far less likely than `taken` by equation error.
    """
    distinct = {trial.obeyed(rewired(trial.run_set.boat, taken)): taken}
    for some in every:
        distinct.setdefault(trial.obeyed(rewired(trial.run_set.boat, some)), some)
    likely_by_response = wiring_likelihoods(
        trial.whole, [rewired(trial.run_set.boat, some) for some in distinct.values()], trial.offset
    )
    every = [
        some
        for some, likelihood in zip(distinct.values(), likely_by_response, strict=True)
        if likelihood >= likely_by_response[0] - LIKELIER
    ][1:]
    boats = [rewired(trial.run_set.boat, some) for some in every]
    glance = [chi2 for chi2, _ in each(lambda boat: trial.fitted(boat, steps=1), boats)]
    likely = [i for i in np.argsort(glance)[:LIKELY] if glance[i] < FAR * least]
    if not likely:
        return None
    chi2 = [chi2 for chi2, _ in each(trial.fitted, [boats[i] for i in likely])]
    best = int(np.argmin(chi2))
    return (chi2[best], every[likely[best]]) if chi2[best] < CLEARLY * least else None


def _one_by_one(trial: _Trial, changes: list[Change]) -> tuple[float, list[Change]]:
    """chi2 and changes, of which each made it clearly better."""
    taken: list[Change] = []
    least = trial.fitted(trial.run_set.boat)[0]
    while len(taken) < len(trial.run_set.boat.thrusters):
        every = [[*taken, change] for change in changes if change not in taken]
        found = _best_of(trial, taken, every, least)
        if found is None:
            break
        least, taken = found
    return least, taken
