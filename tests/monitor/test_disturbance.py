"""The filter's states for an unknown force."""

import numpy as np

from swamp_rl.monitor.disturbance import FORCED, ForcedModel
from swamp_rl.monitor.options import DEFAULT
from swamp_rl.monitor.tracker import filtered_over, noise_level, noise_of
from swamp_rl.navigation.predict import BoatModel
from swamp_rl.simulator import parameters
from tests.support.live_stream import BOAT, stream

TIME_CONSTANT = 5.0  # s
STATE = np.array([1.0, 2.0, 0.7, 0.8, 0.1, 0.05, 0.1, -0.1, 0.02, -0.03, 0.01])


def predicted(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    model = ForcedModel(BoatModel(BOAT), TIME_CONSTANT)
    return model.predict(x, np.zeros(8), 0.1)


def test_the_jacobian_is_the_derivative_of_the_step() -> None:
    jacobian = predicted(STATE)[1]
    for place in range(FORCED):
        moved = STATE.copy()
        moved[place] += 1e-5
        slope = (predicted(moved)[0] - predicted(STATE)[0]) / 1e-5
        np.testing.assert_allclose(jacobian[:, place], slope, atol=1e-3)


def test_an_acceleration_to_the_north_is_one_astern_when_the_boat_heads_south() -> None:
    x = np.zeros(FORCED)
    x[2], x[8] = np.pi, 0.1
    still = x.copy()
    still[8] = 0.0
    change = predicted(x)[0] - predicted(still)[0]
    np.testing.assert_allclose(change[3:6], [-0.01, 0.0, 0.0], atol=1e-12)
    assert change[8] == 0.1 * np.exp(-0.1 / TIME_CONSTANT)


def test_gusts_of_an_unknown_wind_are_likelier_with_an_unknown_force() -> None:
    effects = [
        {"effect": "wind", "speed": 4.0, "from": 1.0},
        {"effect": "gusts", "speed_std": 0.8, "direction_std": 0.1},
    ]
    samples = list(stream(60.0, 0.0, effects))
    sigmas = noise_of(BOAT, samples, 0.1)

    def least(strengths: tuple[float, ...]) -> float:
        levels = [noise_level(BOAT, walk, s, DEFAULT) for walk in (0.05, 0.2, 0.5) for s in strengths]
        record = parameters(BOAT)
        return min(filtered_over(BOAT, record, samples, sigmas, one, 0.1, DEFAULT)[0] for one in levels)

    assert least((2.0, 4.0)) < least((0.0,)) - 20.0
