"""Thrust allocation against the pseudo-inverse, SLSQP, a brute-force grid, symmetry and its own promises."""

import itertools
import math
from functools import cache

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.sparse import csc_matrix

from swamp_rl.allocation import Jets, Wish, allocate, force_region, jets_of, largest_multiple
from swamp_rl.allocation.problem import compressed
from swamp_rl.allocation.sectors import sectors_of
from swamp_rl.boat import Boat, load_boat
from swamp_rl.errors import UserError
from swamp_rl.physics.thrusters import bollard_thrust, effective_thrust, jet_force
from swamp_rl.simulator import parameters

pytestmark = pytest.mark.numerical

Array = NDArray[np.float64]

BOAT = load_boat("swamp-thesis")  # thrust deduction, and jets that turn once either way
JETS = jets_of(BOAT)
TURN = {"azimuth_min": -2.0 * math.pi, "azimuth_max": 2.0 * math.pi}

SMALL = np.array([4.0, -2.5, 1.2])
MIRROR = np.array([1, 0, 3, 2])  # bs, bp, ss, sp exchange their sides
wrenches = st.tuples(st.floats(-45, 45), st.floats(-45, 45), st.floats(-25, 25)).map(np.array)
azimuths = st.lists(st.floats(-6.0, 6.0), min_size=4, max_size=4).map(np.array)


@cache
def stopped() -> Jets:
    """Jets that turn once either way and no further."""
    turned = tuple(one.model_copy(update=TURN) for one in BOAT.thrusters)
    return jets_of(BOAT.model_copy(update={"thrusters": turned}))


def slsqp(jets: Jets, wanted: Array, cost: str, start: Array) -> Array:
    """The same problem by SciPy, in extended thrust vectors (8,), effort or sum of a power of the thrusts."""

    def thrusts(x: Array) -> Array:
        return np.hypot(x[0::2], x[1::2])

    power = {"effort": 2.0, "thrust": 1.0, "power": 1.5}[cost]
    return minimize(
        lambda x: float(((thrusts(x) / jets.thrust_max) ** power).sum()),
        start,
        method="SLSQP",
        constraints=[
            {"type": "eq", "fun": lambda x: jets.geometry @ x - wanted},
            {"type": "ineq", "fun": lambda x: jets.thrust_max**2 - thrusts(x) ** 2},
        ],
        options={"maxiter": 500, "ftol": 1e-12},
    ).x


def test_unconstrained_it_is_the_pseudo_inverse() -> None:
    found = allocate(JETS, SMALL)
    assert found.forces.ravel() == pytest.approx(np.linalg.pinv(JETS.geometry) @ SMALL, abs=1e-5)
    assert found.attainable


@pytest.mark.parametrize("cost", ["effort", "thrust", "power"])
@pytest.mark.parametrize("wanted", [(27.0, 14.0, -4.0), (-10.0, 22.0, 6.0)])
def test_at_the_thrust_limits_it_costs_no_more_than_slsqp_finds(
    cost: str, wanted: tuple[float, float, float]
) -> None:
    want = np.array(wanted)
    found = allocate(JETS, want, wish=Wish(cost))  # type: ignore[arg-type]
    start = np.linalg.pinv(JETS.geometry) @ want
    other = slsqp(JETS, want, cost, start).reshape(4, 2)
    power = {"effort": 2.0, "thrust": 1.0, "power": 1.5}[cost]
    spent, theirs = (
        float(((np.hypot(*forces.T) / JETS.thrust_max) ** power).sum()) for forces in (found.forces, other)
    )
    assert found.attainable
    assert spent == pytest.approx(theirs, rel=1e-3)
    assert np.hypot(*found.forces.T).max() <= JETS.thrust_max[0] + 1e-6


@settings(max_examples=25)
@example(np.array([1.0, 0.0, 1.0]), np.array([0.0, 4.0, 0.0, 0.0]), math.inf)  # past the end of a jet's range
@example(np.array([2.0, 1.0, 0.0]), np.array([0.0, 0.0, 0.0, 5.0]), 0.2)  # within reach of that end
@given(wrenches, azimuths, st.sampled_from([0.05, 0.2, math.inf]))
def test_every_answer_keeps_every_limit_and_says_truly_what_it_achieves(
    wanted: Array, now: Array, step: float
) -> None:
    found = allocate(stopped(), wanted, now, step)
    assert np.all((found.throttle >= 0.0) & (found.throttle <= 1.0))
    assert np.all(np.abs(found.azimuth) <= 2 * math.pi + 1e-9)
    assert np.all(np.abs(found.azimuth - now) <= JETS.azimuth_rate * step + 1e-6)
    record = parameters(BOAT)[0]
    given_forces = [jet_force(found.azimuth[k], found.throttle[k], k, record) for k in range(4)]
    achieved = JETS.geometry @ np.array(given_forces).ravel()
    assert achieved == pytest.approx(found.achieved, abs=2e-4)
    missed = np.linalg.norm((wanted - achieved) / [1, 1, JETS.lever])
    assert missed < 2e-4 if found.attainable else missed > 1e-5


@settings(max_examples=15)
@given(wrenches)
def test_it_is_mirror_symmetric(wanted: Array) -> None:
    found = allocate(JETS, wanted)
    mirrored = allocate(JETS, wanted * [1, -1, -1])
    assert mirrored.forces[MIRROR] * [1, -1] == pytest.approx(found.forces, abs=3e-3)


def test_out_of_reach_it_is_the_nearest_by_least_squares() -> None:
    wanted = np.array([30.0, -20.0, 9.0])
    found = allocate(JETS, wanted)
    assert not found.attainable
    scale = np.array([1.0, 1.0, 1.0 / JETS.lever])
    best = minimize(
        lambda x: float((((JETS.geometry @ x - wanted) * scale) ** 2).sum()),
        np.zeros(8),
        method="SLSQP",
        constraints=[{"type": "ineq", "fun": lambda x: JETS.thrust_max**2 - x[0::2] ** 2 - x[1::2] ** 2}],
        options={"maxiter": 500, "ftol": 1e-12},
    )
    assert found.achieved == pytest.approx(JETS.geometry @ best.x, abs=0.02)
    assert np.linalg.norm((found.achieved - wanted) * scale) <= math.sqrt(best.fun) + 1e-3


@pytest.mark.parametrize("times", [1e2, 1e4, 1e8, 1e14])
def test_a_force_however_far_out_of_reach_has_a_nearest_one(times: float) -> None:
    wanted = np.array([20.0, 12.0, 4.0])
    far = 100.0 * wanted  # from where the answer hardly moves along the ray
    found, nearer = (allocate(JETS, force) for force in (times * far, far))
    assert not found.attainable
    assert found.achieved == pytest.approx(nearer.achieved, abs=0.02 * float(JETS.thrust_max.sum()))


def test_where_not_all_can_be_had_the_moment_may_come_first() -> None:
    wanted = np.array([0.0, 60.0, 9.0])
    even, turning = (allocate(JETS, wanted, wish=Wish(moment=weight)) for weight in (1.0, 20.0))
    assert not turning.attainable
    assert abs(turning.achieved[2] - 9.0) < 0.2 * abs(even.achieved[2] - 9.0)


def test_two_jets_do_what_a_grid_over_angles_and_thrusts_finds() -> None:
    jets = JETS.without(["ss", "sp"])
    wanted = np.array([6.0, 2.0, 1.0])
    found = allocate(jets, wanted, wish=Wish("effort"))
    best = math.inf
    # X1 + X2, Y1 + Y2 and the moment leave one of four unknowns free: a search along it.
    particular = np.linalg.lstsq(jets.geometry[:, :4], wanted, rcond=None)[0]
    null = np.linalg.svd(jets.geometry[:, :4])[2][-1]
    for along in np.linspace(-20, 20, 40001):
        forces = (particular + along * null).reshape(2, 2)
        thrusts = np.hypot(*forces.T)
        if np.all(thrusts <= jets.thrust_max[:2]):
            best = min(best, float(((thrusts / jets.thrust_max[:2]) ** 2).sum()))
    spent = float(((np.hypot(*found.forces.T) / jets.thrust_max) ** 2).sum())
    assert spent == pytest.approx(best, rel=1e-5)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_a_failed_thruster_is_never_used(count: int) -> None:
    for failed in itertools.combinations(BOAT.thruster_names, count):
        found = allocate(JETS.without(failed), np.array([20.0, 9.0, -5.0]))
        dead = [BOAT.thruster_names.index(name) for name in failed]
        assert np.all(found.throttle[dead] == 0.0)
        assert np.all(found.forces[dead] == 0.0)
        assert not found.attainable or count < 3


def test_no_jet_pushes_into_a_forbidden_sector() -> None:
    jets = jets_of(BOAT, forbidden={"bs": [(0.5, 2.0)], "bp": [(-2.0, -0.5)]})
    for wanted in (np.array([2.0, 8.0, 0.0]), np.array([2.0, -8.0, 1.0])):
        found = allocate(jets, wanted)
        assert found.attainable
        for k, (low, high) in enumerate([(0.5, 2.0), (-2.0, -0.5)]):
            pushes = found.throttle[k] > 1e-6
            assert not (pushes and low + 1e-6 < math.remainder(found.azimuth[k], 2 * math.pi) < high - 1e-6)


def test_a_forbidden_sector_leaves_the_rest_of_the_circle() -> None:
    jets = jets_of(BOAT, forbidden={"bs": [(3.0, -3.0)]})  # across the stern, 0.28 rad
    width = sum(sector.high - sector.low for sector in sectors_of(jets, 0, 0.0, math.inf))
    assert width == pytest.approx(6.0)
    assert sectors_of(jets, 0, math.pi, 0.1) == []


def test_the_least_thrust_is_kept_while_the_force_is_met() -> None:
    jets = jets_of(BOAT, thrust_min=1.0)
    found = allocate(jets, np.array([1.0, 0.5, 0.2]), np.full(4, 0.3), step=0.2)
    assert np.hypot(*found.forces.T).min() >= 1.0 - 1e-5
    assert found.attainable  # pushing against one another


def test_a_jet_that_points_the_wrong_way_turns_round_without_thrust_and_then_pushes() -> None:
    jets = jets_of(BOAT, azimuth_rate=math.radians(60))
    now, wanted = np.zeros(4), np.array([-8.0, 0.0, 0.0])
    met = []
    for _ in range(40):
        found = allocate(jets, wanted, now, 0.1)
        now = found.azimuth
        met.append(found.attainable)
    assert not met[0]
    assert met[-1]
    assert met.index(True) in range(14, 31)  # a quarter to a half turn at 6 degrees a step


def test_a_wound_up_azimuth_turns_back_rather_than_past_its_end() -> None:
    now = np.full(4, 2 * math.pi - 0.1)
    wanted = np.array([0.0, 8.0, 0.0])  # to starboard: a quarter turn beyond the end
    for _ in range(12):
        now = allocate(stopped(), wanted, now, 0.1).azimuth
    assert now == pytest.approx(np.full(4, math.pi / 2), abs=0.1)


def test_an_azimuth_without_end_goes_the_short_way_round_however_often_it_turned() -> None:
    endless, turned = jets_of(load_boat("swamp")), 3.0 * 2.0 * math.pi - 0.1
    wanted = np.array([0.0, 8.0, 0.0])  # to starboard: a quarter turn on
    now = np.full(4, turned)
    for _ in range(12):
        now = allocate(endless, wanted, now, 0.1).azimuth
    assert now == pytest.approx(np.full(4, 3.0 * 2.0 * math.pi + math.pi / 2), abs=0.1)


def test_a_penalty_on_change_keeps_the_forces_near_the_last() -> None:
    null = np.linalg.svd(JETS.geometry)[2][-1].reshape(4, 2)
    before = allocate(JETS, SMALL).forces + 2.0 * null  # the same force and moment, dearly bought
    lazy, plain = (allocate(JETS, SMALL, wish=Wish(change=c), before=before) for c in (9.0, 0.0))
    assert lazy.achieved == pytest.approx(SMALL, abs=1e-4)
    assert lazy.forces - plain.forces == pytest.approx(0.9 * (before - plain.forces), abs=1e-3)


def test_the_throttle_gives_the_thrust_back() -> None:
    for name in ("swamp", "swamp-light"):
        boat = load_boat(name)
        jets, record = jets_of(boat), parameters(boat)[0]
        for thrust in np.linspace(0.0, 9.15, 23):
            throttles = jets.throttles(np.full(4, thrust))
            assert effective_thrust(throttles[0], 0, record) == pytest.approx(thrust, abs=1e-9)


def with_fixed(boat: Boat) -> Boat:
    """The boat with its bow jets fixed ahead, and reversing with half the thrust."""
    changes = {"kind": "fixed", "azimuth_min": 0.0, "azimuth_max": 0.0, "astern_quadratic": 6.1}
    jets = [one.model_copy(update=changes if one.x > 0 else {}) for one in boat.thrusters]
    return boat.model_copy(update={"thrusters": tuple(jets)})


def test_fixed_and_reversing_jets_push_along_their_line_alone() -> None:
    jets = jets_of(with_fixed(BOAT))
    assert jets.astern_max[:2] == pytest.approx(6.1 * 0.75)
    found = allocate(jets, np.array([-12.0, 1.0, 0.5]))
    assert found.attainable
    assert np.all(found.azimuth[:2] == 0.0)
    assert found.forces[:2, 1] == pytest.approx(np.zeros(2), abs=1e-9)
    assert np.all(found.throttle[:2] < 0.0)


def test_a_propeller_with_its_rudder_is_refused_and_so_is_an_unknown_name() -> None:
    with pytest.raises(UserError, match="propeller with its rudder"):
        jets_of(load_boat("esso_osaka"))
    with pytest.raises(UserError, match="'bow': the boat has bs, bp, ss, sp"):
        jets_of(BOAT, failed=["bow"])
    with pytest.raises(UserError, match="thrust_min"):
        jets_of(BOAT, thrust_min=20.0)


def test_the_attainable_region_is_the_sum_of_the_jets_discs() -> None:
    """Its support function is known: each jet gives its most along B' d."""
    rng = np.random.default_rng(4)
    for failed in ([], ["bs"], ["bs", "sp"]):
        jets = JETS.without(failed)
        for _ in range(4):
            wanted = rng.normal(size=3) * [10, 10, 5]
            most = largest_multiple(jets, wanted)
            directions = rng.normal(size=(4000, 3))
            pull = np.abs(np.linalg.norm((directions @ jets.geometry).reshape(-1, 4, 2), axis=2))
            support = (pull * jets.thrust_max * jets.works).sum(axis=1)
            along = directions @ wanted
            bound = float(np.min(np.where(along > 0, support / np.maximum(along, 1e-12), np.inf)))
            assert most <= bound * (1 + 1e-6)
            assert most >= 0.9 * bound  # the bound closes in as directions are added
            assert allocate(jets, 0.999 * most * wanted).attainable
            assert not allocate(jets, 1.01 * most * wanted).attainable


def test_one_jet_holds_only_forces_through_its_place() -> None:
    alone = JETS.without(["bp", "ss", "sp"])
    through = np.array([0.35, 0.40, 0.0])
    assert largest_multiple(alone, through) * np.hypot(0.35, 0.40) == pytest.approx(9.15, rel=1e-5)
    assert largest_multiple(alone, np.array([1.0, 0.0, 0.0])) == 0.0
    assert largest_multiple(JETS.without(BOAT.thruster_names), through) == 0.0


def test_four_jets_push_four_times_as_hard_every_way_at_no_moment() -> None:
    border = force_region(JETS, directions=8)
    assert np.hypot(*border.T) == pytest.approx(np.full(8, 4 * 9.15), rel=1e-5)


def test_deduction_makes_two_jets_cheaper_than_four_in_thrust_but_not_in_power() -> None:
    """Thesis 7.3.5 has it that two fast jets do better than four slow ones: of thrust before deduction."""
    record = parameters(BOAT)[0]
    four, two = (
        [bollard_thrust(p, k, record) for k, p in enumerate(jets.throttles(share))]
        for jets, share in ((JETS, np.full(4, 1.0)), (JETS, np.array([2.0, 2.0, 0.0, 0.0])))
    )
    assert sum(two) < sum(four)
    assert sum(np.power(two, 1.5)) > sum(np.power(four, 1.5))


def test_two_jets_that_can_hardly_turn_still_have_a_nearest_force() -> None:
    """The solver's own scaling stopped short of it, once in a simulated night of station keeping."""
    turned = np.array([0.0, 0.0, 18.41978091670886, 4.2773670916144023])
    before = np.array([[0.0, 0.0], [0.0, 0.0], [1.45200992, -0.71458901], [-0.48024437, -0.73069447]])
    jets, wish = (
        jets_of(load_boat("swamp"), failed=("bs", "bp")),
        Wish(cost="effort", change=0.05, moment=5.0),
    )
    found = allocate(jets, np.array([-5.46405663, 4.77926115, 0.17922798]), turned, 0.2, wish, before)
    assert np.all(np.isfinite(found.achieved))


def test_a_matrix_in_compressed_columns_is_the_one_that_scipy_makes_of_coordinates() -> None:
    rng = np.random.default_rng(0)
    keys = zip(rng.integers(0, 12, 40).tolist(), rng.integers(0, 30, 40).tolist(), strict=True)
    entries = {key: float(value) for key, value in zip(keys, rng.normal(size=40), strict=True)}
    columns, rows = zip(*entries, strict=True)
    expected = csc_matrix((list(entries.values()), (rows, columns)), shape=(30, 12))
    made = compressed(entries, 30, 12)
    for part in ("indptr", "indices", "data"):
        np.testing.assert_array_equal(getattr(made, part), getattr(expected, part))
    assert compressed({}, 3, 2).nnz == 0
