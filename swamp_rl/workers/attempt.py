"""One job, tried once."""

from collections.abc import Callable

Work = Callable[[str], str]
"""What is done with a job: from its argument to its answer. Found by its name in the worker."""


def attempt(work: Work, job: str) -> tuple[str | None, str]:
    """The answer (None where it failed) and what went wrong, in one line."""
    try:
        return work(job), ""
    except Exception as error:
        return None, " ".join(f"{type(error).__name__}: {error}".split())
