"""The short memory of pilots: what each boat saw and did at its last decisions, nothing of a run before."""

import numpy as np

from swamp_rl.pilots.memory import Memory


def test_the_past_is_reported_latest_first_and_a_blank_one_is_at_rest_where_it_is_now() -> None:
    memory = Memory(2, 1)
    memory.begin(1)
    np.testing.assert_array_equal(memory.recall(np.array([[5.0]])), [[5, 5, 0, 0, 5, 0, 0]])
    memory.keep(np.array([[5.0]]), np.array([[1.0, 0.5]]))
    np.testing.assert_array_equal(memory.recall(np.array([[6.0]])), [[6, 5, 1, 0.5, 5, 0, 0]])
    memory.keep(np.array([[6.0]]), np.array([[0.2, -1.0]]))
    np.testing.assert_array_equal(memory.recall(np.array([[7.0]])), [[7, 6, 0.2, -1, 5, 1, 0.5]])


def test_boats_remember_each_by_itself_and_forget_when_they_start_anew() -> None:
    rng = np.random.default_rng(0)
    together, alone = Memory(3, 4), Memory(3, 4)
    together.begin(2)
    alone.begin(1)
    seen, levers = rng.normal(size=(6, 2, 4)), rng.normal(size=(6, 2, 2))
    for t in range(3):
        together.keep(seen[t], levers[t])
    together.forget(np.array([False, True]))
    for t in range(3, 6):
        np.testing.assert_array_equal(together.recall(seen[t])[1:], alone.recall(seen[t, 1:]))
        together.keep(seen[t], levers[t])
        alone.keep(seen[t, 1:], levers[t, 1:])


def test_boats_that_do_not_decide_now_keep_their_past() -> None:
    memory = Memory(1, 1)
    memory.begin(2)
    memory.keep(np.array([[1.0], [2.0]]), np.zeros((2, 2)))
    memory.keep(np.array([[3.0]]), np.ones((1, 2)), np.array([1]))
    np.testing.assert_array_equal(memory.recall(np.zeros((2, 1)))[:, 1:], [[1, 0, 0], [3, 1, 1]])
    assert Memory(0, 3).seen_width == 3
