"""Items that are worked on in threads."""

import sys
import time
from threading import Barrier, get_ident

import numba
import pytest

from swamp_rl.criticism.options import options, using
from swamp_rl.criticism.threads import divided, each


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


@pytest.mark.parametrize(("threads", "parts"), [(2, 1), (5, 1), (8, 2)])
def test_work_in_a_thread_is_divided_among_its_share_of_the_threads(
    threads: int, parts: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", threads)

    def work(item: int) -> int:
        made = list[slice]()
        divided(made.append, 8, 10**9)
        return len(made)

    with using(most_together=4):
        assert each(work, range(6)) == [parts] * 6


def test_parts_cover_every_item_once_and_an_error_in_one_reaches_the_caller(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 3)
    parts = list[slice]()
    divided(parts.append, 8, 10**9)
    assert sorted(i for part in parts for i in range(8)[part]) == list(range(8)) and len(parts) == 3

    def fails(part: slice) -> None:
        if part.stop == 8:
            raise MemoryError("no room")

    with pytest.raises(MemoryError, match="no room"):
        divided(fails, 8, 10**9)


def test_threads_give_way_as_before_once_the_work_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 2)
    before = sys.getswitchinterval()
    during = each(lambda _: sys.getswitchinterval(), range(2))
    assert max(during) < before == sys.getswitchinterval()


def test_after_an_error_no_other_item_is_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 2)
    begun = list[int]()

    def work(item: int) -> None:
        begun.append(item)
        if item == 0:
            raise KeyboardInterrupt
        time.sleep(0.02)

    with pytest.raises(KeyboardInterrupt):
        each(work, range(200))
    assert len(begun) < 200
