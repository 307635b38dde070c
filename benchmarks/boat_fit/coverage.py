"""Coverage of the intervals of `swamp-rl identify boat` on synthetic boats of random kind and size.

    python -m benchmarks.boat_fit.coverage 100 9

A hundred boats from seed 9. The truth of each is drawn from the priors about a start file; every other
one sails in a mean wind with gusts.
"""

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.boat import Boat, PropellerRudder, load_boat
from swamp_rl.boat.mapping import boat_mapping
from swamp_rl.boat.quantity import SPREAD
from swamp_rl.boat_fit.fit import fit_boat
from swamp_rl.boat_fit.hypothesis import FreeBoat, free_boat
from swamp_rl.boat_numbers.numbers import free_numbers
from swamp_rl.constants import Z95
from swamp_rl.criticism.data.measurement_noise import noise_levels, weights
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.model.rollout import roll
from swamp_rl.criticism.model.scales import state_scale
from swamp_rl.errors import UserError
from swamp_rl.files import write_yaml
from swamp_rl.one_thread import one_thread
from swamp_rl.simulator import initial_state, tank
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.sensors import observe
from swamp_rl.simulator.substeps import substeps_of

Array = NDArray[np.float64]

SHIPPED = {"azimuth": "swamp-light", "propeller_rudder": "esso_osaka", "twin": "swamp-light"}
LENGTHS = 0.3, 20.0  # m
FROUDE = {
    "m": 1.0,
    "m2": 2.0,
    "kg": 3.0,
    "kg m2": 5.0,
    "N": 3.0,
    "s": 0.5,
    "rad/s": -0.5,
    "m/s": 0.5,
    "rps": -0.5,
}
RUNS, ROWS = 2, 2000
AFTER = 30  # rows simulated beyond the last, for a receiver whose clock is behind
NOISE = np.array([0.02, 0.02, 0.01, 0.02, 0.02, 0.02])  # in `state_scale`
GUSTY, GUST = 0.1, 0.03  # of the air's speed, in top speeds; mean wind and gusts
FASTEST = 3.0  # top speeds of the start boat, beyond which a draw is left out


def enlarged(section: Any, ratio: float) -> Any:
    """A boat file's section `ratio` times as long, by Froude's law."""
    if isinstance(section, list):
        return [enlarged(part, ratio) for part in section]
    if not isinstance(section, dict):
        return section
    if "unit" in section:
        power = FROUDE.get(section["unit"], 0.0)
        sizes = [key for key in ("value", SPREAD) if key in section and power != 0.0]
        return section | {key: np.multiply(section[key], ratio**power).tolist() for key in sizes}
    return {name: enlarged(part, ratio) for name, part in section.items()}


def twin(whole: dict[str, Any]) -> dict[str, Any]:
    """Two fixed thrusters that reverse, in place of the boat's own."""
    kept = []
    for thruster in whole["thrusters"][2:]:
        gone = ("azimuth_min", "azimuth_max", "azimuth_rate", "azimuth_time_constant", "azimuth_offset")
        fixed = {key: value for key, value in thruster.items() if key not in gone}
        ahead = {"value": 0.0, "unit": "rad", "provenance": "assumed", "source": "ahead"}
        astern = {**thruster["thrust_quadratic"], "value": 0.7 * thruster["thrust_quadratic"]["value"]}
        kept.append(
            fixed | {"kind": "fixed", "azimuth_min": ahead, "azimuth_max": ahead, "astern_quadratic": astern}
        )
    joypad = {"thrusters": [one["name"] for one in kept], "throttle": whole["joypad"]["throttle"]}
    return whole | {"thrusters": kept, "joypad": joypad}


def start_boat(rng: np.random.Generator) -> tuple[str, Boat]:
    """A start file of random kind and size."""
    kind = str(rng.choice(list(SHIPPED)))
    shipped = load_boat(SHIPPED[kind])
    low, high = np.log(LENGTHS)
    whole = enlarged(boat_mapping(shipped), float(np.exp(rng.uniform(low, high))) / shipped.length)
    whole = twin(whole) if kind == "twin" else whole
    whole.pop("battery", None)  # not on the motion
    with tempfile.TemporaryDirectory() as folder:
        write_yaml(Path(folder) / "start.yaml", whole | {"name": kind})
        return kind, load_boat(Path(folder) / "start.yaml")


def drawn(hypothesis: FreeBoat, rng: np.random.Generator) -> Array:
    """(p,) numbers from their priors, within their bounds."""
    mean, sd = hypothesis.prior()[0], hypothesis.prior()[1] ** -0.5
    correlation = np.linalg.inv(hypothesis.prior_precision * np.outer(sd, sd))
    root = np.linalg.cholesky(correlation)
    low, high = hypothesis.bounds()
    correlated = hypothesis.prior_precision != 0.0
    x = np.full(len(mean), np.nan)
    while (outside := ~((x >= low) & (x <= high))).any():
        x = np.where(correlated @ outside, mean + sd * (root @ rng.standard_normal(len(mean))), x)
    return x


def commands(boat: Boat, dt: float, rng: np.random.Generator) -> Array:
    """(RUNS, ROWS, 2K) random steps of every thruster."""
    count, passing = len(boat.thrusters), reference_of(boat).time
    made = np.zeros((RUNS, ROWS, 2 * count))
    for run in made:
        for k, thruster in enumerate(boat.thrusters):
            most = (
                thruster.rudder_max
                if isinstance(thruster, PropellerRudder)
                else min(thruster.azimuth_max, 1.2)
            )
            limits = (-most, most) if thruster.kind != "fixed" else (0.0, 0.0)
            for column, (low, high) in (
                (k, limits),
                (count + k, (thruster.throttle_min, thruster.throttle_max)),
            ):
                row = 0
                while row < ROWS:
                    rows = max(2, int(rng.uniform(1.0, 10.0) * passing / dt))
                    run[row : row + rows, column] = rng.uniform(low, high)
                    row += rows
    return made


def sailed(hypothesis: FreeBoat, boat: Boat, x: Array, gusty: bool, rng: np.random.Generator) -> RunSet:
    """Noisy runs of the boat with numbers x (p,)."""
    of = reference_of(boat)
    dt = float(np.clip(0.1 * of.time, 0.05, 0.2))
    given = commands(boat, dt, rng)
    record = np.repeat(hypothesis.records(boat, x[None]), RUNS)
    if gusty:
        record["wind_speed"], record["wind_from"] = GUSTY * of.speed * 20.0, rng.uniform(-3.0, 3.0, RUNS)
        record["gust_speed_std"], record["gust_direction_std"] = GUST * of.speed * 20.0, 0.2
    start = initial_state(record, np.zeros((RUNS, 3)))
    track = np.empty((RUNS, ROWS + AFTER, 6))
    whole = np.concatenate([given, np.repeat(given[:, -1:], AFTER, axis=1)], axis=1)
    run, first = np.arange(RUNS), np.zeros(RUNS, int)
    steps = np.full(RUNS, ROWS + AFTER - 1)
    seeds = rng.integers(1, 1 << 31, RUNS).astype(np.uint64)
    calm = np.zeros((0, 0, 3))
    roll(
        record,
        run,
        tank(boat),
        start,
        whole,
        calm,
        run,
        first,
        steps,
        seeds,
        dt,
        substeps_of(dt, boat),
        1,
        np.zeros((0, 1, 3)),
        1,
        track,
    )
    if not np.isfinite(track).all() or np.abs(track[..., 3]).max() > FASTEST * of.speed:
        raise UserError("the motion diverges")
    measured = observe(track, record, dt, np.zeros(RUNS))[:, :ROWS]
    measured = measured + NOISE * state_scale(boat) * rng.standard_normal(measured.shape)
    if rng.random() < 0.5:
        measured[..., 3:] = np.nan  # a receiver and a compass alone
    return RunSet(boat, dt, tuple(f"run {i}" for i in run), given, measured, np.full(RUNS, ROWS))


def drawn_boat(number: int, seed: int) -> tuple[str, Boat, FreeBoat, Array, RunSet]:
    """Kind, start file, free numbers, their truth (p,) and the runs of boat `number`."""
    rng = np.random.default_rng([seed, number])
    while True:
        kind, boat = start_boat(rng)
        plain = free_boat(boat, free_numbers(boat))
        truth = drawn(plain, rng)
        try:
            return kind, boat, plain, truth, sailed(plain, boat, truth, in_gusts(number), rng)
        except UserError:
            continue


def in_gusts(number: int) -> bool:
    """Whether boat `number` sails in gusts."""
    return number % 2 == 1


def covered(number: int, seed: int) -> tuple[str, Array]:
    """A description of boat `number` and, of each number, how many standard errors it is off."""
    gusty = in_gusts(number)
    kind, boat, plain, truth, runs = drawn_boat(number, seed)
    hypothesis = free_boat(boat, plain.numbers, RUNS, ("wind",) if gusty else ())
    began = time.process_time()
    made = fit_boat(runs, weights(runs, noise_levels(runs)), hypothesis, hypothesis.start())
    count = len(truth)
    errors = np.sqrt(np.diag(made.covariance))[:count]
    off = (made.fit.x[:count] - truth) / errors
    message = f"{kind} {boat.length:.2f} m{' gusts' if gusty else ''} {time.process_time() - began:.0f} s"
    far = [f"{n.name} {z:+.1f}" for n, z in zip(plain.numbers, off, strict=True) if abs(z) > 3.0]
    return f"{message}; {np.mean(np.abs(off) < Z95):.2f} of {count}; {', '.join(far)}", off


def coverage_table(offs: dict[str, list[Array]]) -> str:
    """Share of the intervals that contain the truth, of the boats in each weather and of all."""
    rows = []
    for name, some in (*offs.items(), ("all", [*offs["calm"], *offs["gusts"]])):
        off = np.concatenate([np.zeros(0), *some])
        rows.append([name, str(len(some)), str(len(off)), f"{np.mean(np.abs(off) < Z95):.3f}"])
    return table(["boats in", "boats", "95 % intervals", "coverage"], rows)


@one_thread()
def main(count: int, seed: int) -> None:
    """Print a line a boat, and write the coverage of the intervals after each pair of boats."""
    every: dict[str, list[Array]] = {"calm": [], "gusts": []}
    for number in range(count):
        line, off = covered(number, seed)
        every["gusts" if in_gusts(number) else "calm"].append(off)
        print(f"{number}: {line}", flush=True)
        if in_gusts(number) or number == count - 1:
            write_parts(DOCS / "identify_boat.md", {"coverage": coverage_table(every)})
    print(coverage_table(every))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
