"""The reservoir's readout: one Gram matrix for all ridges, errors on other rows, and learning row by row."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.readout import (
    Moments,
    RecursiveReadout,
    ridge_readout,
    ridge_readouts,
    squared_error,
    variance_matched,
)

pytestmark = pytest.mark.numerical


def rows(seed: int, count: int = 300, units: int = 12) -> tuple[Array, Array]:
    """States that lie close to each other, as a reservoir's do, and levers that follow them roughly."""
    rng = np.random.default_rng(seed)
    states = np.tanh(rng.normal(size=(count, 4)) @ rng.normal(size=(4, units)) + rng.normal(size=units))
    return states, states @ rng.normal(size=(units, 2)) + 0.3 + 0.1 * rng.normal(size=(count, 2))


def stacked(states: Array, levers: Array, ridge: float) -> Array:
    """The same by least squares on rows with the ridge's own below: no Gram matrix."""
    units = states.shape[1]
    x, y = states - states.mean(axis=0), levers - levers.mean(axis=0)
    weights = np.linalg.lstsq(
        np.vstack([x, np.sqrt(ridge) * np.eye(units)]), np.vstack([y, np.zeros((units, 2))]), rcond=None
    )[0]
    return np.vstack([weights, levers.mean(axis=0) - states.mean(axis=0) @ weights])


def test_one_gram_matrix_gives_the_readout_of_each_ridge() -> None:
    states, levers = rows(0)
    moments, ridges = Moments.of([states], [levers]), (1e-3, 0.1, 3.0, 100.0)
    for ridge, found in zip(ridges, ridge_readouts(moments, ridges), strict=True):
        np.testing.assert_allclose(found, stacked(states, levers, ridge), atol=1e-9)
        np.testing.assert_allclose(ridge_readout(moments, ridge), found, atol=1e-9)


def test_the_error_from_sums_is_that_of_the_rows() -> None:
    (states, levers), (others, theirs) = rows(0), rows(1)
    readout = ridge_readout(Moments.of([states], [levers]), 1.0)
    error = others @ readout[:-1] + readout[-1] - theirs
    found = squared_error(readout, Moments.of([others], [theirs]))
    assert found == pytest.approx(np.square(error).mean(), rel=1e-9)


def test_sums_without_a_part_are_those_of_the_rest() -> None:
    (first, its), (second, theirs) = rows(0), rows(1)
    rest = Moments.of([first, second], [its, theirs]) - Moments.of([second], [theirs])
    np.testing.assert_allclose(rest.gram, Moments.of([first], [its]).gram, atol=1e-9)
    np.testing.assert_allclose(rest.cross, Moments.of([first], [its]).cross, atol=1e-9)


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 10**6), st.floats(0.01, 100.0))
def test_row_by_row_without_forgetting_ends_where_all_at_once_does(seed: int, ridge: float) -> None:
    states, levers = rows(seed)
    online = RecursiveReadout(states.shape[1], ridge)
    for state, lever in zip(states, levers, strict=True):
        online.learn(state, lever)
    expected = ridge_readout(Moments.of([states], [levers]), ridge)
    np.testing.assert_allclose(online.readout, expected, rtol=0.0, atol=1e-8)


def test_with_forgetting_it_is_the_least_squares_with_weights_that_fade() -> None:
    states, levers = rows(3)
    online = RecursiveReadout(states.shape[1], 1e-6, forgetting=0.98)
    for state, lever in zip(states, levers, strict=True):
        online.learn(state, lever)
    weight = np.sqrt(0.98 ** np.arange(len(states))[::-1])[:, None]
    wide = np.column_stack([states, np.ones(len(states))])
    expected = np.linalg.lstsq(weight * wide, weight * levers, rcond=None)[0]
    np.testing.assert_allclose(online.readout, expected, atol=1e-4)


def test_what_has_changed_is_learned_by_one_that_forgets_and_not_by_one_that_does_not() -> None:
    states, levers = rows(4, count=600)
    levers[300:] = -levers[300:]
    errors = []
    for forgetting in (1.0, 0.98):
        online = RecursiveReadout(states.shape[1], 1e-3, forgetting)
        for state, lever in zip(states, levers, strict=True):
            online.learn(state, lever)
        errors.append(np.square(states @ online.readout[:-1] + online.readout[-1] - levers)[300:].mean())
    assert errors[1] < 0.05 * errors[0]


def test_variance_matched_levers_have_the_mean_square_of_the_demonstrations() -> None:
    states, levers = rows(3)
    moments = Moments.of([states], [np.sign(levers)])
    ridge = ridge_readout(moments, 30.0)
    scaled = variance_matched(ridge, moments)
    predicted = states @ scaled[:-1] + scaled[-1]
    np.testing.assert_allclose(np.square(predicted).mean(axis=0), 1.0, rtol=1e-9)
    gains = scaled / ridge
    np.testing.assert_allclose(gains, np.broadcast_to(gains[0], gains.shape), rtol=1e-9)
    assert (gains > 1.0).all()


def test_of_one_state_about_nought_it_is_the_reduced_major_axis() -> None:
    """Its slope is the ratio of the spreads, whatever the correlation and the ridge."""
    rng = np.random.default_rng(4)
    state = rng.normal(size=(500, 1))
    levers = np.sign(state @ [[1.0, -2.0]] + rng.normal(size=(500, 2)))
    state, levers = state - state.mean(axis=0), levers - levers.mean(axis=0)
    moments = Moments.of([state], [levers])
    for ridge in (1e-3, 300.0):
        slope = variance_matched(ridge_readout(moments, ridge), moments)[0]
        np.testing.assert_allclose(slope, [1.0, -1.0] * levers.std(axis=0) / state.std(), rtol=1e-9)


def test_a_lever_that_was_never_touched_stays_at_nought() -> None:
    states, levers = rows(5)
    levers[:, 0] = 0.0
    moments = Moments.of([states], [levers])
    assert (variance_matched(ridge_readout(moments, 1.0), moments)[:, 0] == 0.0).all()
