"""The streams of the benchmark hold what its tables count."""

from dataclasses import replace

from benchmarks.monitor.sail import BOAT, stream
from swamp_rl.monitor import Monitor, Notice
from swamp_rl.monitor.options import DEFAULT, Options


def notices(options: Options) -> list[Notice]:
    monitor = Monitor(BOAT, options)
    return [notice for sample in stream(10_515, 36.0, rough=True) for notice in monitor.feed(sample)]


def test_a_gust_that_looks_like_a_stronger_thruster_is_not_named() -> None:
    credulous = replace(DEFAULT, sea=0.0)
    assert [notice.cause.split()[0] for notice in notices(credulous)] == ["thruster_gain"]
    assert notices(DEFAULT) == []
