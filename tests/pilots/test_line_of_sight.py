"""The line-of-sight pilot steers in proportion to the bearing of the gate, and is a baseline of its own."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.batched import GatesVectorEnv

from swamp_rl.evaluation import drive
from swamp_rl.pilots.line_of_sight import LineOfSightPilot, LineOfSightSettings
from swamp_rl.pilots.store import load_pilot, save_pilot

UNTUNED = LineOfSightSettings(gain=2.0, damping=1.0, lead=0.0, beyond=0.0)


def seen(bearing: float, distance: float, gate: float, yaw_rate: float = 0.0) -> np.ndarray:
    """Observation (1, 5) of a gate at a bearing [rad] and distance [m], pointing `gate` [rad] off the bow."""
    where = [distance * np.cos(bearing), distance * np.sin(bearing)]
    return np.array([[*where, np.cos(gate), np.sin(gate), yaw_rate]])


def test_the_angle_is_the_gain_by_the_bearing_less_the_damped_yaw_rate() -> None:
    levers = LineOfSightPilot(UNTUNED).act(seen(0.2, 8.0, 0.0, yaw_rate=0.1))
    np.testing.assert_allclose(levers, [[1.0, 2.0 * 0.2 - 0.1]])
    np.testing.assert_allclose(LineOfSightPilot(UNTUNED).act(seen(-2.0, 8.0, 0.0)), [[1.0, -1.0]])


def test_it_aims_before_the_gate_by_its_lead_and_behind_it_by_what_is_beyond() -> None:
    # The gate is 8 m ahead, 2 m to starboard and points ahead: half of 8 m before it, 1 m behind that.
    pilot = LineOfSightPilot(LineOfSightSettings(gain=1.0, damping=0.0, lead=0.5, beyond=1.0))
    levers = pilot.act(np.array([[8.0, 2.0, 1.0, 0.0, 0.0]]))
    np.testing.assert_allclose(levers[0, 1], np.arctan2(2.0, 8.0 - 4.0 + 1.0))


def test_tuned_it_succeeds_in_calm_water_and_more_often_than_untuned_at_severe() -> None:
    def success(settings: LineOfSightSettings | None, level: str) -> float:
        def make(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
            return GatesVectorEnv(n, disturbances=level, observation=senses)

        rollout = drive(LineOfSightPilot(settings), make, 3_000_000 + np.arange(200))
        return float(np.mean(rollout.outcome == "success"))

    assert success(None, "calm") > 0.98
    assert success(None, "severe") > success(UNTUNED, "severe")


@pytest.mark.parametrize("settings", [UNTUNED, LineOfSightSettings(lead=0.4, throttle=0.5)])
def test_it_is_stored_by_its_options(tmp_path: Path, settings: LineOfSightSettings) -> None:
    save_pilot(LineOfSightPilot(settings), tmp_path / "stored")
    assert load_pilot(tmp_path / "stored").settings() == settings.model_dump(mode="json")
