"""Packages that not every user needs: extras of the project, imported where they are used."""

from swamp_rl.errors import UserError


def missing(needs: str, extra: str, otherwise: str = "") -> UserError:
    """The error of what `needs` a package that is not installed, with the command that installs its extra.

    needs: such as `GPS positions need pyproj`; otherwise: what to do without the extra, if anything.
    """
    return UserError(f"{needs}; {command(extra)}{f', or {otherwise}' if otherwise else ''}")


def command(extra: str) -> str:
    """What installs an extra."""
    return f"pip install 'swamp-rl[{extra}]'"
