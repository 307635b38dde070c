"""Consistency of the extended Kalman filter and a GPS loss of 20 s, with and without the boat's model.

    python -m benchmarks.navigation.dead_reckoning

Writes the tables of docs/navigation.md.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import Boat, load_boat
from swamp_rl.effects import parse_effects
from swamp_rl.navigation.filter import COASTING, START, WITH_MODEL, Navigator
from swamp_rl.navigation.predict import STATES, BoatModel, Coasting
from swamp_rl.navigation.sensors import Sensors
from swamp_rl.navigation.simulated import Navigated, navigate

Array = NDArray[np.float64]

RUNS = 20
BEFORE, LOSS = 30.0, 20.0  # s with GPS, s without
SENSORS = Sensors()
BOAT = load_boat("swamp")
COARSE = START * np.array([1, 1, 1, 1, 1, 1, 1 / 3, 1 / 3])
WILD = np.array([1.0, 1.0, 0.05, 0.3, 0.3, 0.1, 0.3, 0.3])


def zigzag(time: float, navigator: Navigator, azimuths: Array) -> Array:
    """Bow and stern azimuths opposed, over every 8 s."""
    angle = 0.4 if (time // 8) % 2 == 0 else -0.4
    return np.array([angle, angle, -angle, -angle, 0.6, 0.6, 0.6, 0.6])


def among(effects: list[dict[str, object]]) -> Boat:
    """SWAMP in these effects."""
    return BOAT.model_copy(
        update={"effects": tuple(parse_effects(effects, "benchmark", BOAT.thruster_names))}
    )


def own_world(seed: int, unsure: Array = COARSE) -> Navigated:
    """A run with just the randomness that the filter assumes, `unsure` (8,) of its start."""
    rng = np.random.default_rng(seed)
    x = unsure * rng.standard_normal(STATES)
    navigator = Navigator(BoatModel(BOAT), np.zeros(STATES), WITH_MODEL, np.diag(unsure**2))
    boat = among([{"effect": "current", "north": float(x[6]), "east": float(x[7])}])
    return navigate(boat, navigator, SENSORS, zigzag, 40.0, rng, walk=WITH_MODEL, pose=x[:3], velocity=x[3:6])


def other_boat(rng: np.random.Generator) -> Boat:
    """A boat that is not the model: current, wind, gusts, thrust and hull coefficients drawn."""
    names = ("x_vr", "y_v", "y_r", "n_v", "n_r")
    scales = {name: float(1 + 0.12 * rng.standard_normal()) for name in names}
    return among(
        [
            {"effect": "current", "north": rng.uniform(-0.2, 0.2), "east": rng.uniform(-0.2, 0.2)},
            {"effect": "wind", "speed": 3.0, "from": rng.uniform(-3.1, 3.1)},
            {"effect": "gusts", "speed_std": 1.0, "direction_std": 0.2},
            {"effect": "thrust_scale", "scale": 1 + 0.05 * rng.standard_normal()},
            {"effect": "hull_coefficients", **scales},
        ]
    )


def loss(seed: int, with_model: bool) -> tuple[float, float, float]:
    """Position error [m] before the loss, after 10 s and after 20 s of it."""
    rng = np.random.default_rng([5, seed])
    boat = other_boat(rng)
    predictor, walk = (BoatModel(BOAT), WITH_MODEL) if with_model else (Coasting(), COASTING)
    navigator = Navigator(predictor, np.zeros(STATES), walk)
    end = BEFORE + LOSS
    error = navigate(boat, navigator, SENSORS, zigzag, end, rng, lost=(BEFORE, end + 1)).position_error
    rows = (round(BEFORE / 0.1) - 2, round((BEFORE + LOSS / 2) / 0.1) - 1, -1)
    return float(error[rows[0]]), float(error[rows[1]]), float(error[rows[2]])


def consistency_rows() -> list[list[str]]:
    """NIS and NEES against their chi-square bounds."""
    runs = [own_world(seed) for seed in range(RUNS)]
    rows = []
    for name, values in (
        ("innovations of the GPS (2)", np.concatenate([run.nis_gps for run in runs])),
        ("innovations of the AHRS (2)", np.concatenate([run.nis_ahrs for run in runs])),
    ):
        low, high = chi2.ppf([0.005, 0.995], 2 * values.size) / values.size
        rows.append([name, f"{values.mean():.3f}", f"{low:.3f} to {high:.3f}"])
    low, high = chi2.ppf([0.025, 0.975], 6 * RUNS) / RUNS
    wild = [own_world(seed, WILD) for seed in range(RUNS)]
    for name, tried in (("errors of pose and velocity (6)", runs), ("the same, begun unsure", wild)):
        nees = np.array([run.nees for run in tried])
        inside = np.mean((nees.mean(axis=0) >= low) & (nees.mean(axis=0) <= high))
        rows.append([name, f"{nees.mean():.2f}", f"{low:.2f} to {high:.2f}, {inside:.0%} of the time inside"])
    return rows


def loss_rows() -> list[list[str]]:
    """Median and 90th percentile of the position error."""
    rows = []
    for name, with_model in (("boat's model", True), ("coasting", False)):
        errors = np.array([loss(seed, with_model) for seed in range(RUNS)])
        middle, bad = np.median(errors, axis=0), np.quantile(errors, 0.9, axis=0)
        rows.append([name, *(f"{m:.2f} ({b:.2f})" for m, b in zip(middle, bad, strict=True))])
    return rows


def main() -> None:
    """Write the tables."""
    heads = ["dead reckoning by", "before", f"after {LOSS / 2:.0f} s", f"after {LOSS:.0f} s"]
    parts = {
        "consistency": table(["", "mean", "bounds"], consistency_rows()),
        "loss of GPS": table(heads, loss_rows()),
    }
    write_parts(DOCS / "navigation.md", parts)


if __name__ == "__main__":
    main()
