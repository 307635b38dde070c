"""A log is divided where most of its messages begin again, not where one of them jumps."""

import numpy as np
import pytest

from swamp_rl.logs.log import Log, LogTable
from swamp_rl.logs.restarts import parts_between_restarts
from swamp_rl.runs.table import Table


def messages(name: str, time: list[float]) -> LogTable:
    values = np.arange(float(len(time)))
    return LogTable(name, Table({"value": values}, np.arange(1, len(time) + 1)), np.array(time))


BOOTS = [0.0, 5.0, 9.0, 0.1, 4.0]


@pytest.mark.parametrize(
    ("times", "parts"),
    [
        ([BOOTS, BOOTS], 2),
        ([BOOTS, BOOTS, [0.0]], 2),  # one message, kept for who comes late
        ([BOOTS, [0.0, 1.0, 2.0], [0.0, 2.0, 9.0]], 1),
        ([[0.0, 1.0, 0.9, 2.0], [0.0, 1.0, 0.9, 2.0]], 1),  # late messages
    ],
)
def test_a_log_has_as_many_parts_as_most_of_its_tables(times: list[list[float]], parts: int) -> None:
    log = Log("log.bin", "log", {f"t{k}": messages(f"t{k}", one) for k, one in enumerate(times)})
    found = parts_between_restarts(log)
    assert len(found) == parts
    if parts == 1:
        assert found == [log]
    else:
        rows = [one.tables["t0"].table.columns["value"].tolist() for one in found]
        assert rows == [[0.0, 1.0, 2.0], [3.0, 4.0]]
