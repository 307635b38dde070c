"""Commands in reports, as the run format calls them."""

from swamp_rl.boat import Boat

COMMANDS = "azimuth", "throttle"
"""First words of the variables that are commands, in the order of a thruster's columns."""


def as_column(variable: str, boat: Boat) -> str:
    """`azimuth main` of a propeller with a rudder as `rudder main`, `throttle main` as `propeller main`.

    `azimuth` alone is of all thrusters. Other variables are returned as they are.
    """
    kind, _, name = variable.partition(" ")
    if kind not in COMMANDS:
        return variable
    columns = [one.command_columns[COMMANDS.index(kind)] for one in boat.thrusters if name in ("", one.name)]
    kinds = {column.partition("_")[0] for column in columns if column is not None}
    return f"{kinds.pop()} {name}".rstrip() if len(kinds) == 1 else variable
