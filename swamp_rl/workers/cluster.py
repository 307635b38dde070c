"""Jobs on a Ray cluster that is there already; a lost node's jobs are reported as failed."""

import logging
import socket
from typing import Any, Self

from swamp_rl.errors import UserError
from swamp_rl.extras import missing
from swamp_rl.workers.attempt import Work, attempt

PATIENCE = 5.0  # s


class RayPool:
    """As many jobs at once as the cluster has processors; Ray chooses where."""

    def __init__(self, work: Work, address: str) -> None:
        """address: as of `ray.init`, such as 127.0.0.1:6379. UserError where no cluster answers there."""
        if not address.strip():  # for which Ray would start a cluster of its own
            raise UserError("--ray is empty; give the address of a cluster, such as 127.0.0.1:6379")
        try:
            import ray
        except ImportError as error:
            raise missing("a cluster needs Ray", "ray") from error
        _answers(address, ray.util.get_node_ip_address())
        try:
            ray.init(address, log_to_driver=False, logging_level=logging.ERROR, configure_logging=False)
        except (ConnectionError, ValueError, RuntimeError, OSError) as error:
            raise _refused(address, error) from error
        self._ray = ray
        self._attempt = ray.remote(num_cpus=1, max_retries=0)(attempt)
        self._work = work
        self._running: dict[Any, int] = {}
        self.size = max(1, int(ray.cluster_resources().get("CPU", 1)))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._ray.shutdown()

    def submit(self, number: int, job: str) -> None:
        """Have job `number` done somewhere."""
        self._running[self._attempt.remote(self._work, job)] = number

    def wait(self) -> tuple[int, str | None, str]:
        """Wait for a job to end: its number, its answer (None where it failed), what went wrong."""
        (ended, *_), _ = self._ray.wait(list(self._running), num_returns=1)
        number = self._running.pop(ended)
        try:
            answer, error = self._ray.get(ended)
        except self._ray.exceptions.RayError as lost:
            return number, None, f"its worker was lost ({type(lost).__name__})"
        return number, answer, error


def _answers(address: str, here: str) -> None:
    """UserError where nobody listens at HOST:PORT, which Ray itself would find out after minutes.

    here: by which Ray calls this machine, and so puts in the place of 127.0.0.1.
    """
    host, colon, port = address.removeprefix("ray://").rpartition(":")
    if not colon or not port.isdigit():
        return
    local = host in ("127.0.0.1", "localhost") and not address.startswith("ray://")
    try:
        socket.create_connection((here if local else host, int(port)), PATIENCE).close()
    except (OSError, OverflowError) as error:
        raise _refused(address, error) from error


def _refused(address: str, error: Exception) -> UserError:
    line = " ".join(str(error).split())[:200]
    return UserError(f"--ray {address}: no cluster answers ({line}); start one there with ray start")
