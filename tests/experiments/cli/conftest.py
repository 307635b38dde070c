"""`call`: the command line, called in this process."""

from tests.support.command_line import call

__all__ = ["call"]
