"""A scripted pilot that imitates how people drove at Camogli (thesis 7.3.3, figures 7.30 to 7.32, 7.35).

Full throttle most of the time, steering at zero or at its ends, a reaction delay, hesitations, wrong guesses
and a share of messy runs. Its runs are marked `scripted`.
"""

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from swamp_rl.angles import wrapped_below
from swamp_rl.constants import LONGEST_BOAT, SHORTEST_BOAT, SWAMP_LENGTH
from swamp_rl.pilots.arrays import Array, checked, checked_count
from swamp_rl.pilots.demonstrations import GATE, MOTION
from swamp_rl.pilots.settings import NotNegative, Positive, Range, Settings, Share


class Habits(Settings):
    """Behaviour of the scripted driver; each range is drawn from uniformly, once a run.

    Angles in rad, times in s, distances in m, lever positions in [0, 1]. None of these is measured: they were
    chosen so that the commands resemble figure 7.35 and most runs succeed, as at the festival.
    """

    reaction: Range = (0.2, 0.35)
    "Reaction time."
    dead_band: Range = (0.06, 0.15)
    "Course error without reaction."
    anticipation: Range = (0.5, 0.9)
    "Prediction horizon of the turning."
    drift_seen: Range = (0.5, 1.0)
    "Share of the drift angle that is taken into account."
    aim_spread: NotNegative = 0.25
    "Largest lateral offset of the aim from the middle of the gate."
    swing: Range = (0.3, 0.5)
    "Width of the S: the aim lies this share of the distance before the gate."
    gentle: Share = 0.1
    "Share of runs with intermediate steering angles."
    excursion: Range = (0.5, 0.8)
    "Steering angle in these runs while the course error is small."
    alarm: Positive = 0.35
    "Course error above which the lever goes to its end in these runs too."
    guess_interval: Positive = 25.0
    "Mean time between wrong guesses, with the lever to the wrong side."
    guess_duration: Range = (0.3, 0.7)
    hesitation_interval: Positive = 30.0
    "Mean time between hesitations, with the throttle at zero."
    hesitation_duration: Range = (0.3, 1.0)
    messy: Share = 0.15
    "Share of messy runs: slower reactions and many wrong guesses."
    messy_reaction: Range = (0.3, 0.5)
    messy_guess_interval: Positive = 5.0
    boat_length: Annotated[float, Field(ge=SHORTEST_BOAT, le=LONGEST_BOAT)] = SWAMP_LENGTH
    "Length of the boat: distances and times of turning are those of SWAMP, scaled by Froude's law."


SKILLS = {
    "novice": Habits(
        reaction=(0.35, 0.55),
        dead_band=(0.12, 0.3),
        anticipation=(0.2, 0.6),
        drift_seen=(0.0, 0.5),
        aim_spread=0.5,
        gentle=0.0,
        guess_interval=8.0,
        guess_duration=(0.5, 1.0),
        hesitation_interval=12.0,
        messy=0.4,
        messy_reaction=(0.5, 0.8),
    ),
    "usual": Habits(),
    "expert": Habits(
        reaction=(0.15, 0.25),
        dead_band=(0.04, 0.08),
        anticipation=(0.7, 0.9),
        drift_seen=(0.8, 1.0),
        aim_spread=0.1,
        gentle=0.0,
        guess_interval=120.0,
        hesitation_interval=120.0,
        messy=0.0,
    ),
}
"Drivers of different skill; chosen, not measured, as `Habits` are."
Skill = Literal["novice", "usual", "expert"]


def habits_of(skill: Skill, boat_length: float) -> Habits:
    """The habits of a driver of that skill on a boat of that length [m]."""
    return SKILLS[skill].model_copy(update={"boat_length": boat_length})


SCHEDULE = 32
"Number of slips drawn for a run; there are none after the last."


class ScriptedPilot:
    """Bang-bang steering towards the next gate, with another approach when the gate was missed.

    Boat i draws its habits from the seed, i (its place at `reset`) and the number of runs it has begun, so
    its behaviour does not depend on how many others are driven beside it.
    """

    kind: ClassVar[str] = "scripted"
    senses: tuple[str, ...] = (*MOTION, *GATE)

    def __init__(self, seed: int, habits: Habits | None = None, step: float = 0.1) -> None:
        """seed >= 0; step is the time between decisions [s]."""
        self.seed = seed
        self.habits = habits or Habits()
        self.step = step
        length = self.habits.boat_length / SWAMP_LENGTH
        speed = length**0.5
        # Surge, sway, yaw rate, gate ahead, to starboard, its cosine and sine, over what they are on SWAMP.
        self._unit = np.array([speed, speed, 1.0 / speed, length, length, 1.0, 1.0])
        self._history = 1 + round(max(self.habits.reaction[1], self.habits.messy_reaction[1]) / step)
        self.reset(0)

    def reset(self, n: int) -> None:
        """Set the number of boats to n, each at its first run."""
        n = checked_count(n)
        self._numbers = np.arange(n)
        self._runs = np.zeros(n, dtype=np.int64)
        self._traits = np.zeros(n, dtype=_TRAITS)
        self._time = np.zeros(n)
        self._seen = np.zeros((n, self._history))
        self._lever = np.zeros(n)
        self._begin(np.arange(n))

    def reset_boats(self, mask: Array) -> None:
        """Draw new habits for the boats of `mask` (n,), which start their next run."""
        boats = np.flatnonzero(mask)
        self._runs[boats] += 1
        self._begin(boats)

    def keep(self, boats: Array) -> None:
        """Keep only the boats with the indices `boats` (m,)."""
        self._numbers, self._runs, self._traits = self._numbers[boats], self._runs[boats], self._traits[boats]
        self._time, self._seen, self._lever = self._time[boats], self._seen[boats], self._lever[boats]

    def act(self, observation: Array) -> Array:
        """Levers (n, 2), throttle and angle, from the observation (n, 7) in the order of `senses`."""
        seen = checked(observation, self.senses, len(self._seen))
        traits = self._traits
        self._seen = np.roll(self._seen, 1, axis=1)
        self._seen[:, 0] = _course_error(seen / self._unit, traits)
        error = self._seen[np.arange(len(self._seen)), np.minimum(traits["delay"], self._ticks())]
        # Hysteresis: the lever is released at a smaller error than it is pushed at.
        threshold = np.where(self._lever == 0.0, traits["dead_band"], 0.4 * traits["dead_band"])
        self._lever = np.where(np.abs(error) > threshold, np.sign(error), 0.0)
        guessing = self._within("guess")
        wrong = np.where(self._lever == 0.0, traits["whim"], -self._lever)
        gentle = np.where(np.abs(error) < self.habits.alarm, traits["excursion"], 1.0)
        angle = np.where(guessing, wrong, self._lever) * gentle
        throttle = np.where(self._within("hesitation"), 0.0, 1.0)
        self._time += self.step
        return np.stack([throttle, angle], axis=1)

    def settings(self) -> dict[str, Any]:
        """What is needed to build the same pilot again, as plain JSON."""
        return {"seed": self.seed, "step": self.step, "habits": self.habits.model_dump(mode="json")}

    def weights(self) -> dict[str, Array]:
        """Nothing was learned."""
        return {}

    @classmethod
    def build(cls, settings: dict[str, Any], weights: dict[str, Array]) -> "ScriptedPilot":
        """The pilot of `settings` (from `settings()`)."""
        return cls(settings["seed"], Habits(**settings["habits"]), settings["step"])

    def _ticks(self) -> Array:
        return np.round(self._time / self.step).astype(np.int64)

    def _within(self, slip: str) -> Array:
        begin, end = self._traits[f"{slip}_begin"], self._traits[f"{slip}_end"]
        now = self._time[:, None]
        return np.any((now >= begin) & (now < end), axis=1)

    def _begin(self, boats: Array) -> None:
        self._time[boats] = 0.0
        self._seen[boats] = 0.0
        self._lever[boats] = 0.0
        for boat in boats:
            rng = np.random.default_rng([self.seed, int(self._numbers[boat]), int(self._runs[boat])])
            self._traits[boat] = _draw_traits(self.habits, self.step, rng)


_TRAITS = np.dtype(
    [
        ("delay", np.int64),
        *((name, np.float64) for name in ("dead_band", "anticipation", "drift_seen", "aim", "swing")),
        *((name, np.float64) for name in ("excursion", "whim")),
        *((name, np.float64, (SCHEDULE,)) for name in ("guess_begin", "guess_end")),
        *((name, np.float64, (SCHEDULE,)) for name in ("hesitation_begin", "hesitation_end")),
    ]
)


def _draw_traits(habits: Habits, step: float, rng: np.random.Generator) -> Any:
    """One run's habits: a record of `_TRAITS`."""
    traits = np.zeros((), dtype=_TRAITS)
    messy = rng.random() < habits.messy
    gentle = rng.random() < habits.gentle
    excursion = rng.uniform(*habits.excursion)
    traits["delay"] = round(rng.uniform(*(habits.messy_reaction if messy else habits.reaction)) / step)
    traits["dead_band"] = rng.uniform(*habits.dead_band)
    traits["anticipation"] = rng.uniform(*habits.anticipation)
    traits["drift_seen"] = rng.uniform(*habits.drift_seen)
    traits["aim"] = rng.uniform(-habits.aim_spread, habits.aim_spread)
    traits["swing"] = rng.uniform(*habits.swing)
    traits["excursion"] = excursion if gentle else 1.0
    traits["whim"] = rng.choice([-1.0, 1.0])
    interval = habits.messy_guess_interval if messy else habits.guess_interval
    _draw_slips(traits, "guess", interval, habits.guess_duration, rng)
    _draw_slips(traits, "hesitation", habits.hesitation_interval, habits.hesitation_duration, rng)
    return traits


def _draw_slips(traits: Any, slip: str, interval: float, duration: Range, rng: np.random.Generator) -> None:
    """A Poisson schedule of moments with the mean interval [s] and the range of durations [s]."""
    begin = np.cumsum(rng.exponential(interval, SCHEDULE))
    traits[f"{slip}_begin"] = begin
    traits[f"{slip}_end"] = begin + rng.uniform(*duration, SCHEDULE)


def _course_error(observation: Array, traits: Array) -> Array:
    """Return the course error (n,) [rad], positive to starboard, less the predicted turning."""
    surge, sway, yaw_rate, ahead, starboard, gate_cos, gate_sin = observation.T
    along = -(ahead * gate_cos + starboard * gate_sin)
    across = ahead * gate_sin - starboard * gate_cos
    aim_along, aim_across = _aim(along, across, traits)
    to_along, to_across = aim_along - along, aim_across - across
    bearing = np.arctan2(
        to_along * gate_sin + to_across * gate_cos, to_along * gate_cos - to_across * gate_sin
    )
    drift = np.where(surge > 0.3, np.arctan2(sway, np.maximum(surge, 0.3)), 0.0)
    return wrapped_below(bearing - traits["drift_seen"] * drift) - traits["anticipation"] * yaw_rate


def _aim(along: Array, across: Array, traits: Array) -> tuple[Array, Array]:
    """Return the aim in the gate's frame [m]: along its direction and across, positive to starboard."""
    to_go = np.maximum(-along - 1.5, 0.0)
    aim_along = np.where(to_go > 0.0, -traits["swing"] * to_go, 1.5)
    aim_across = traits["aim"]
    # Past the gate or too far to the side: return for another approach, by a turning circle (about 8 m in
    # diameter) from the gate's middle line.
    side = np.where(across < 0.0, -1.0, 1.0)
    aside = np.abs(across) - 1.8
    missed = ((aside > 0.0) & (along > -0.5 * aside)) | (along > 0.3)
    return np.where(missed, -5.0, aim_along), np.where(missed, 8.0 * side, aim_across)
