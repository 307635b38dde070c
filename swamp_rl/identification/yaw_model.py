"""The yaw model of paper 002, eq. 1, by pseudo-inversion (eq. 2) and by rollout."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swamp_rl.errors import UserError
from swamp_rl.identification.estimate import BLOCK, Estimate, blocks_of, pseudo_inverse, with_intervals
from swamp_rl.identification.identifiability import doubts
from swamp_rl.identification.motion import Motion

Array = NDArray[np.float64]

UNITS = ("N m s", "N s2", "N s2", "N m/rad")
NAMES = ("k_r", "c_ru", "c_rv", "b_r")
WINDOW = 10.0  # s of each rollout
STEERED = 0.02  # rad by which the steering angle must change
NEEDED = "zig-zags at several angles and speeds"
FAR = 1e6  # rad/s at which a diverging rollout is cut off


class YawModel(NamedTuple):
    """I r' = k_r r + c_ru r |u| + c_rv r |v| + b_r δ, with I [kg m2], SI and radians (eq. 1)."""

    k_r: float
    c_ru: float
    c_rv: float
    b_r: float
    inertia: float

    def damping(self, surge: float, sway: float = 0.0) -> float:
        """Moment [N m s] per yaw rate against the turn; negative where the model turns ever faster."""
        return -(self.k_r + self.c_ru * abs(surge) + self.c_rv * abs(sway))

    def steady_rate(self, angle: float, surge: float, sway: float = 0.0) -> float:
        """Yaw rate [rad/s] at which the model settles for an azimuth [rad]; infinite where it does not."""
        damping = self.damping(surge, sway)
        return self.b_r * angle / damping if damping > 0.0 else math.inf

    def time_constant(self, surge: float, sway: float = 0.0) -> float:
        """s; infinite where the model does not settle."""
        damping = self.damping(surge, sway)
        return self.inertia / damping if damping > 0.0 else math.inf

    @property
    def unstable_above(self) -> float:
        """Surge [m/s] from which the model no longer settles, without sway; infinite if it always does."""
        return -self.k_r / self.c_ru if self.c_ru > 0.0 else math.inf


PUBLISHED = YawModel(-13.5227, 7.2526, 2.6854, 3.9683, inertia=7.58)
"Table III."


def regressors(motion: Motion) -> Array:
    """(T, 4) r, r |u|, r |v|, δ (eq. 2)."""
    u, v, r = motion.velocity.T
    return np.column_stack([r, r * np.abs(u), r * np.abs(v), motion.steering])


def by_pseudo_inverse(motion: Motion, inertia: float) -> tuple[YawModel, list[Estimate]]:
    """Eq. 2: the measured rows times the pseudo-inverse; with intervals from resampled blocks of 5 s.

    UserError where the steering angle never changes.
    """
    _refuse_unsteered(motion.steering, "throughout")
    X, y = regressors(motion), inertia * motion.derivative[:, 2]
    blocks = blocks_of(motion.lengths, max(1, round(BLOCK / motion.step)))
    found = with_intervals(X, y, blocks, pseudo_inverse, UNITS)
    return YawModel._make([*(one.value for one in found), inertia]), found


def _refuse_unsteered(angle: Array, where: str) -> None:
    """UserError unless the steering angle [rad] changes."""
    if np.ptp(angle) < STEERED:
        held = math.degrees(float(angle.mean()))
        raise UserError(f"no steering: the angle is {held:.1f} deg {where}; record {NEEDED}")


def yaw_model_doubts(motion: Motion, found: Sequence[Estimate]) -> list[str | None]:
    """Why the rows do not determine k_r, c_ru, c_rv and b_r as found; None where they do."""
    return doubts(regressors(motion), found, motion.lengths, NAMES)


def rollout(model: YawModel, start: Array, surge: Array, sway: Array, steering: Array, dt: float) -> Array:
    """Yaw rates (W, T) from eq. 1, from `start` (W,), with u, v, δ (W, T) held over each dt [s]."""
    rate = (model.k_r + model.c_ru * np.abs(surge) + model.c_rv * np.abs(sway)) / model.inertia
    push = model.b_r / model.inertia * steering
    keep = np.exp(rate * dt)
    gain = np.where(np.abs(rate) > 1e-9, np.expm1(rate * dt) / np.where(rate == 0.0, 1.0, rate), dt)
    r = np.empty_like(surge)
    r[:, 0] = start
    for i in range(surge.shape[1] - 1):
        r[:, i + 1] = keep[:, i] * r[:, i] + gain[:, i] * push[:, i]
    return r


def by_rollout(motion: Motion, guess: YawModel) -> YawModel:
    """The same model fitted to the yaw rate itself: rollouts of 10 s, each from a start of its own.

    No derivative of a noisy signal is taken; surge and sway go in as measured. The starts and b_r act
    linearly and are solved for exactly at every step of the search. UserError where every run is shorter, or
    where the steering angle changes in no rollout.
    """
    from scipy.optimize import least_squares

    rows = round(WINDOW / motion.step)
    if max(motion.lengths) < rows:
        raise UserError(f"every run is shorter than a rollout's {WINDOW:g} s; record longer ones")
    ends = zip(np.cumsum((0, *motion.lengths)), motion.lengths, strict=False)
    starts = [a + i * rows for a, n in ends for i in range(n // rows)]
    cut = np.array(starts)[:, None] + np.arange(rows)
    u, v, r = (motion.velocity[cut, i] for i in range(3))
    steering = motion.steering[cut]
    _refuse_unsteered(steering, f"in all {len(starts)} stretches of {WINDOW:g} s")
    scale = np.maximum(np.abs(guess[:3]), 1.0)

    def separated(x: Array) -> tuple[Array, Array]:
        model = YawModel._make([*(x * scale), 1.0, guess.inertia])
        with np.errstate(over="ignore", invalid="ignore"):
            free = rollout(model, np.ones(len(r)), u, v, 0.0 * steering, motion.step)
            forced = rollout(model, np.zeros(len(r)), u, v, steering, motion.step)
        free, forced = (np.clip(np.nan_to_num(one, nan=FAR), -FAR, FAR) for one in (free, forced))
        return _without(forced, free), _without(r, free)

    def misfit(x: Array) -> Array:
        forced, left = separated(x)
        return (left - forced * (forced * left).sum() / (forced**2).sum()).ravel()

    x = np.asarray(least_squares(misfit, np.array(guess[:3]) / scale, max_nfev=100).x)
    forced, left = separated(x)
    push = float((forced * left).sum() / (forced**2).sum())
    return YawModel._make([*(float(value) for value in x * scale), push, guess.inertia])


def _without(values: Array, direction: Array) -> Array:
    """Rows (W, T) less their part along the rows of `direction`."""
    share = (values * direction).sum(axis=1) / (direction**2).sum(axis=1)
    return values - share[:, None] * direction
