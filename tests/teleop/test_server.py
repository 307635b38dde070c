"""The server of the recorder's page where a signal comes before it serves."""

import gc
import signal
import warnings
from typing import Any

import pytest
import uvicorn

from swamp_rl.teleop.server import OrderlyServer, bound


async def nothing(scope: Any, receive: Any, send: Any) -> None:
    """An application that answers nothing."""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_while_the_loop_is_made_ends_the_server_without_a_warning(
    number: signal.Signals, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(number: int, frame: Any) -> None:
        raise KeyboardInterrupt

    def signalled(config: uvicorn.Config) -> None:
        signal.raise_signal(number)

    monkeypatch.setattr(uvicorn.Config, "get_loop_factory", signalled)
    before = signal.signal(number, stop)
    try:
        with warnings.catch_warnings(record=True) as warned, bound("127.0.0.1", 0) as listening:
            warnings.simplefilter("always")
            server = OrderlyServer(uvicorn.Config(nothing, lifespan="off", log_level="warning"))
            with pytest.raises(KeyboardInterrupt):
                server.run(sockets=[listening])
            gc.collect()
    finally:
        signal.signal(number, before)
    assert [str(one.message) for one in warned] == []
