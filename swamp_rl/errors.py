"""The one exception whose message is meant for the person at the keyboard."""


class UserError(Exception):
    """What is wrong, where (file, row, column or key) and what to do, on one line for each fault."""
