"""The extended Kalman filter: true to its own errors, and what its model is worth when the GPS is lost."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import chi2

from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import parse_effects
from swamp_rl.navigation.filter import COASTING, START, WITH_MODEL, Navigator
from swamp_rl.navigation.predict import STATES, BoatModel, Coasting
from swamp_rl.navigation.sensors import Fix, Sensors, due
from swamp_rl.navigation.simulated import Navigated, navigate

pytestmark = pytest.mark.numerical

Array = NDArray[np.float64]

BOAT = load_boat("swamp")
SURE = START * np.array([1, 1, 1, 1, 1, 1, 1 / 3, 1 / 3])  # the hull's drag is far from linear in the rest
SENSORS = Sensors()


def zigzag(time: float, navigator: Navigator, azimuths: Array) -> Array:
    angle = 0.4 if (time // 8) % 2 == 0 else -0.4
    return np.array([angle, angle, -angle, -angle, 0.6, 0.6, 0.6, 0.6])


def among(north: float, east: float, *more: dict[str, object]) -> Boat:
    given = [{"effect": "current", "north": north, "east": east}, *more]
    return BOAT.model_copy(update={"effects": tuple(parse_effects(given, "test", BOAT.thruster_names))})


def own_world(
    seed: int, sensors: Sensors, believed: Sensors | None = None, seconds: float = 40.0
) -> Navigated:
    """A run whose start, motion and readings have just the randomness that the filter assumes."""
    rng = np.random.default_rng(seed)
    x = SURE * rng.standard_normal(STATES)
    navigator = Navigator(BoatModel(BOAT), np.zeros(STATES), WITH_MODEL, np.diag(SURE**2))
    boat = among(float(x[6]), float(x[7]))
    if believed is not None:
        update = navigator.update
        navigator.update = lambda fix: update(  # type: ignore[method-assign]
            fix._replace(deviations=fix.deviations * believed.position / sensors.position)
        )
    return navigate(
        boat, navigator, sensors, zigzag, seconds, rng, walk=WITH_MODEL, pose=x[:3], velocity=x[3:6]
    )


@pytest.fixture(scope="module")
def ensemble() -> list[Navigated]:
    return [own_world(seed, SENSORS) for seed in range(10)]


def within(values: Array, freedom: int, confidence: float) -> bool:
    """Whether a sum of squares is what chi-square allows."""
    low, high = chi2.ppf([(1 - confidence) / 2, (1 + confidence) / 2], freedom * values.size)
    return bool(low <= values.sum() <= high)


def test_the_innovations_are_as_large_as_the_filter_says(ensemble: list[Navigated]) -> None:
    assert within(np.concatenate([run.nis_gps for run in ensemble]), 2, 0.99)
    assert within(np.concatenate([run.nis_ahrs for run in ensemble]), 2, 0.99)


def test_the_errors_are_as_large_as_the_filter_says(ensemble: list[Navigated]) -> None:
    """Runs are independent, the moments of one run are not: so a test at each moment over all runs."""
    nees = np.array([run.nees for run in ensemble])
    inside = [within(nees[:, i], 6, 0.95) for i in range(0, nees.shape[1], 5)]
    assert np.mean(inside) > 0.8
    assert 5.0 < nees.mean() < 7.2


def test_a_filter_that_trusts_its_sensors_too_much_is_found_out() -> None:
    runs = [own_world(seed, SENSORS, Sensors(position=0.35), seconds=20.0) for seed in range(3)]
    assert not within(np.concatenate([run.nis_gps for run in runs]), 2, 0.99)


def test_the_current_is_found(ensemble: list[Navigated]) -> None:
    rng = np.random.default_rng(1)
    boat = among(0.2, -0.1)
    navigator = Navigator(BoatModel(BOAT), np.zeros(STATES), WITH_MODEL)
    found = navigate(boat, navigator, SENSORS, zigzag, 60.0, rng).estimate[-1, 6:]
    assert found == pytest.approx([0.2, -0.1], abs=0.06)


def lost_by(seed: int, with_model: bool) -> float:
    """Position error [m] after 20 s without GPS; the true boat is not quite the model."""
    rng = np.random.default_rng([5, seed])
    scales = dict(zip(("x_vr", "y_v", "y_r", "n_v", "n_r"), 1 + 0.12 * rng.standard_normal(5), strict=True))
    boat = among(
        *rng.uniform(-0.2, 0.2, 2),
        {"effect": "hull_coefficients"} | {name: float(value) for name, value in scales.items()},
        {"effect": "thrust_scale", "scale": float(1 + 0.05 * rng.standard_normal())},
    )
    if with_model:
        navigator = Navigator(BoatModel(BOAT), np.zeros(STATES), WITH_MODEL)
    else:
        navigator = Navigator(Coasting(), np.zeros(STATES), COASTING)
    run = navigate(boat, navigator, SENSORS, zigzag, 50.0, rng, lost=(30.0, 60.0))
    return float(run.position_error[-1])


def test_the_model_carries_the_boat_through_a_lost_gps() -> None:
    with_model, without = ([lost_by(seed, model) for seed in range(5)] for model in (True, False))
    assert np.median(with_model) < 0.5 * np.median(without)
    assert np.median(with_model) < 1.5


def test_the_heading_may_pass_south() -> None:
    navigator = Navigator(Coasting(), np.zeros(STATES), COASTING)
    navigator.x[2] = math.pi - 0.01
    navigator.update(Fix((2, 5), np.array([-math.pi + 0.01, 0.1]), np.array([0.02, 0.01])))
    assert navigator.x[2] == pytest.approx(math.pi, abs=0.011)

    def circle(time: float, navigator: Navigator, azimuths: Array) -> Array:
        return np.array([0.6, 0.6, -0.6, -0.6, 0.6, 0.6, 0.6, 0.6])

    rng = np.random.default_rng(2)
    navigator = Navigator(BoatModel(BOAT), np.zeros(STATES), WITH_MODEL)
    run = navigate(BOAT, navigator, SENSORS, circle, 60.0, rng)
    assert run.truth[-1, 2] > 2 * math.pi
    assert np.abs(np.sin(run.truth[50:, 2] - run.estimate[50:, 2])).max() < 0.1


def test_sensors_report_at_their_own_rates() -> None:
    for interval, dt, count in ((0.4, 0.1, 25), (0.35, 0.05, 28), (0.1, 0.1, 100), (0.25, 0.1, 40)):
        steps = round(10.0 / dt)
        assert sum(due(interval, (i + 1) * dt, dt) for i in range(steps)) == count
    slow = own_world(3, Sensors(gps_interval=0.9, ahrs_interval=0.25))
    assert (len(slow.nis_gps), len(slow.nis_ahrs)) == (44, 160)
    assert within(slow.nis_ahrs, 2, 0.999)


def test_coasting_has_the_slopes_that_differences_give() -> None:
    rng = np.random.default_rng(0)
    x, step = rng.normal(size=STATES), 1e-6
    commands = np.zeros(8)
    _, slopes = Coasting().predict(x, commands, 0.3)
    for i in range(STATES):
        moved = np.eye(STATES)[i] * step
        ahead, _ = Coasting().predict(x + moved, commands, 0.3)
        behind, _ = Coasting().predict(x - moved, commands, 0.3)
        assert slopes[:, i] == pytest.approx((ahead - behind) / (2 * step), abs=1e-6)
