"""Free-running tests of a model ship on a pond (the tables of Miyauchi 2022 and Wakita 2022) as runs."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swamp_rl.angles import wrapped
from swamp_rl.boat import Boat, PropellerRudder
from swamp_rl.errors import UserError
from swamp_rl.ordinary import ordinary
from swamp_rl.runs.check import check_table
from swamp_rl.runs.run import Run
from swamp_rl.runs.schema import RunMeta
from swamp_rl.runs.table import Table, read_table
from swamp_rl.runs.text_header import LONGEST_HEADER

# Their headings, in SI units already. The pond's x axis takes the place of north and its y axis that of east.
# The true wind is given by where it comes from in the same frame, as `wind_from` is.
COLUMNS = {
    "t [s]": "time",
    "x_position_mid [m]": "north",
    "y_position_mid [m]": "east",
    "psi_hat [rad]": "heading",
    "u_velo [m/s]": "surge",
    "vm_velo [m/s]": "sway",
    "r_angvelo [rad/s]": "yaw_rate",
    "delta_rudder [rad]": "rudder_{name}",
    "n_prop [rps]": "propeller_{name}",
    "wind_velo_true [m/s]": "wind_speed",
    "wind_dir_true [rad]": "wind_from",
}
ANGLES = ("heading", "wind_from")


def import_free_running(path: Path | str, boat: Boat, repair: bool = False) -> Run:
    """The run in one such CSV file, in the columns of `boat`, which must have a propeller with a rudder.

    Velocities are kept as they are: over ground, at midship, filtered by whoever measured them. UserError
    with file, row and column where the table is not one of theirs, or a value is missing or out of range.
    With `repair` the run ends before the first row that is not whole, and its meta says so under
    `repaired`.
    """
    path = Path(path)
    table = read_table(path)
    missing = [name for name in COLUMNS if name not in table.columns]
    if missing and table.columns:
        raise UserError(
            f"{path}: column {missing[0]!r} is missing; this is not a table of free-running tests"
        )
    if not table.columns:
        raise UserError(f"{path}: {table.faults[0].message}")
    whole = np.logical_and.reduce([np.isfinite(table.columns[name]) for name in COLUMNS])
    count = len(whole) if whole.all() else int(np.argmin(whole))
    meta = RunMeta()
    if count < len(whole):
        if not repair:
            raise UserError(f"{path}: {_first_hole(table, count)}")
        left_out = f"row {table.rows[count]} and the {len(whole) - count - 1} after it left out: not whole"
        meta = RunMeta.model_validate({"repaired": left_out})
    columns = _renamed(table, boat, count)
    faults = check_table(path.name, Table(columns, table.rows[:count]), boat, None)
    if faults:
        raise UserError(f"{path.parent / str(faults[0])}")
    return Run(path.stem, columns, meta)


def is_free_running(path: Path) -> bool:
    """Whether a file names the times of such a table in its first line."""
    with ordinary(path, None).open("rb") as file:
        return b"t [s]" in file.readline(LONGEST_HEADER)


def _first_hole(table: Table, index: int) -> str:
    name = next(name for name in COLUMNS if not np.isfinite(table.columns[name][index]))
    holes = sum(not np.isfinite(table.columns[name][i]) for i in range(index, len(table.rows)))
    return (
        f"row {table.rows[index]}, column {name!r}: no number, as in {holes} row(s) of this column; "
        "fill them in, or end the run before them (--repair)"
    )


def _renamed(table: Table, boat: Boat, count: int) -> dict[str, NDArray[np.float64]]:
    actuator = next((found for found in boat.thrusters if isinstance(found, PropellerRudder)), None)
    if actuator is None:
        raise UserError(
            f"boat {boat.name} has no propeller with a rudder; name the boat that made these runs"
        )
    columns = {
        ours.format(name=actuator.name): table.columns[theirs][:count] for theirs, ours in COLUMNS.items()
    }
    for name in ANGLES:
        columns[name] = wrapped(columns[name])
    return columns
