"""A hidden boat that is sought from the file `twin.yaml`, and runs of it."""

from pathlib import Path

from swamp_rl.boat import Boat, load_boat
from swamp_rl.criticism.data.run_set import RunSet, read_run_set
from tests.support.from_scratch import written
from tests.support.sailing import sailed_dataset

HIDDEN = """extends: twin.yaml
name: hidden
added_mass_sway: -10.0
hull: {n_r: -0.11, c_d: 1.3, n_v: -0.09}
resistance: {x_0_ahead: -0.09}
thrusters:
  port: {thrust_quadratic: 6.5, pump_time_constant: 0.3}
  starboard: {thrust_quadratic: 7.0, pump_time_constant: 0.3}
effects:
  - {effect: throttle_dead_band, thruster: all, below: 0.1}
"""


def hidden(folder: Path, text: str) -> Boat:
    """The hidden boat, and twin.yaml, the file to start from, beside it."""
    written(folder, "twin")
    (folder / "hidden.yaml").write_text(text)
    return load_boat(folder / "hidden.yaml")


def start_runs(folder: Path, text: str, **more: float) -> RunSet:
    """Runs of the hidden boat, read as of the file to start from."""
    truth = hidden(folder, text)
    sailed_dataset(folder / "runs", folder / "twin.yaml", truth, **more)  # type: ignore[arg-type]
    return read_run_set(folder / "runs", load_boat(folder / "twin.yaml"))
