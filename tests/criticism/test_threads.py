"""Items that are worked on in threads."""

from threading import Barrier, get_ident

import numba
import pytest

from swamp_rl.criticism.options import options, using
from swamp_rl.criticism.threads import each


def test_items_are_worked_on_together_with_the_options_of_the_caller(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 2)
    both = Barrier(2, timeout=10.0)

    def work(item: int) -> tuple[int, int]:
        both.wait()
        return item, options().thread_steps

    with using(thread_steps=7):
        assert each(work, [4, 3, 2, 1]) == [(4, 7), (3, 7), (2, 7), (1, 7)]


@pytest.mark.parametrize(("threads", "items"), [(1, 3), (2, 1), (2, 0)])
def test_one_thread_or_item_begins_no_thread(
    threads: int, items: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", threads)
    assert each(lambda _: get_ident(), range(items)) == [get_ident()] * items
