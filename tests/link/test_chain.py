"""From a virtual vehicle's log to a dataset and a diagnosis, as a user goes."""

from pathlib import Path

import numpy as np
import pytest
from swamp_rl.envs.aboard import Aboard

from swamp_rl.boat import load_boat
from swamp_rl.criticism.diagnose import diagnose
from swamp_rl.errors import UserError
from swamp_rl.link.helm import Voyage, helm
from swamp_rl.link.network import Faults
from swamp_rl.link.sensor_line import CAMOGLI
from swamp_rl.link.vehicle import Conduct
from swamp_rl.link.voyage_log import lateness_figures, write_voyage
from swamp_rl.navigation.sensors import Sensors
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.runs import read_dataset
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_foreign import Wishes
from tests.support.link import at_the_start, how_far_off
from tests.support.simulated_link import SimulatedLink

WIFI = Faults(loss=0.02, delay=(0.001, 0.004))
"""Of a link between modules on one deck."""


def sailed(
    seed: int = 0, faults: Faults = WIFI, noise: Sensors | None = None
) -> tuple[SimulatedLink, Voyage]:
    """The line-of-sight pilot on the Camogli course, from a start of its own."""
    vehicle = at_the_start(Conduct(seed=seed, noise=noise))
    vehicle.state[0, :3] += np.random.default_rng(seed).uniform(-1.0, 1.0, 3) * (0.5, 0.5, 0.4)
    link = SimulatedLink(vehicle, faults, seed)
    bridge = Aboard(LineOfSightPilot(), boat=vehicle.boat, course="camogli")
    return link, helm(link, bridge, 4, link.clock)


def logged(folder: Path, name: str, link: SimulatedLink) -> Path:
    """The vehicle's telemetry as it writes it."""
    folder.mkdir(exist_ok=True)
    path = folder / f"{name}.log"
    path.write_bytes(b"".join(link.log))
    return path


def test_the_vehicles_log_is_imported_with_its_commands(tmp_path: Path) -> None:
    (link, voyage), about = sailed(), About(course="camogli")
    import_runs(
        [logged(tmp_path, "run", link)], "telemetry", tmp_path / "runs", about, Wishes(origin=CAMOGLI)
    )
    run = read_dataset(tmp_path / "runs").runs[0]
    assert voyage.outcome == run.meta.outcome == "success"
    assert run.columns["throttle_bs"].max() == pytest.approx(max(row[-4] for row in voyage.rows), abs=1e-5)
    assert not run.columns["throttle_ss"].any()
    assert how_far_off(run) < 0.2


def test_the_helms_own_log_is_a_dataset_that_replays(tmp_path: Path) -> None:
    link, voyage = sailed(faults=Faults())
    write_voyage(tmp_path / "runs", voyage, link.vehicle.boat, About(boat="swamp", course="camogli"))
    run = read_dataset(tmp_path / "runs").runs[0]
    assert len(run.time) == len(voyage.rows) and run.meta.outcome == "success"
    assert run.joypad[:, 0].max() > 0.5
    assert how_far_off(run) < 0.2


def test_lost_telemetry_is_interpolated_or_divides_the_log(tmp_path: Path) -> None:
    link, voyage = sailed(faults=Faults(loss=0.15))
    boat = link.vehicle.boat
    del voyage.rows[100:110]
    made = write_voyage(tmp_path / "runs", voyage, boat, About(boat="swamp", course="camogli"))
    assert len(made.runs) >= 2
    for run in read_dataset(tmp_path / "runs").runs:
        assert np.diff(run.time) == pytest.approx(0.1)


def test_a_voyage_without_rows_is_no_dataset(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no telemetry was answered"):
        write_voyage(tmp_path / "runs", Voyage(), load_boat("swamp"), About())
    assert not (tmp_path / "runs").exists()
    assert np.isnan(lateness_figures(Voyage())["p99"])


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
def test_the_vehicles_log_is_diagnosed_as_nothing_wrong(tmp_path: Path) -> None:
    logs = tmp_path / "logs"
    for seed in range(3):
        link, _ = sailed(seed, noise=Sensors())
        logged(logs, f"run_{seed}", link)
    import_runs([logs], "telemetry", tmp_path / "runs", About(boat="swamp"))
    found = diagnose([tmp_path / "runs"], "swamp", tmp_path / "diagnosis")
    assert found.verdict == "nothing_wrong"
