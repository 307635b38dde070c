"""Someone drives for the first seconds, then the learned pilot takes over with the run in its memory."""

import numpy as np

from swamp_rl.pilots.reservoir import fit_reservoir
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.takeover import TakeoverPilot
from tests.support.steering_runs import RUNS, SMALL


def pair() -> tuple[TakeoverPilot, list[int], list[int]]:
    """A takeover after 1.5 s, and where each of the two pilots finds what it senses."""
    pilot = TakeoverPilot(ScriptedPilot(1), fit_reservoir(RUNS, SMALL), 1.5, 0.1)
    places = [[pilot.senses.index(name) for name in half.senses] for half in (pilot.first, pilot.then)]
    return pilot, places[0], places[1]


def test_each_pilot_drives_in_its_time_as_if_it_had_been_there_from_the_start() -> None:
    pilot, first, then = pair()
    scripted, reservoir = ScriptedPilot(1), fit_reservoir(RUNS, SMALL)
    for each in (pilot, scripted, reservoir):
        each.reset(2)
    seen = np.random.default_rng(0).normal(size=(40, 2, len(pilot.senses)))
    for t, observation in enumerate(seen):
        by_first, by_then = scripted.act(observation[:, first]), reservoir.act(observation[:, then])
        np.testing.assert_array_equal(pilot.act(observation), by_first if t < 15 else by_then)


def test_a_boat_that_begins_anew_is_driven_by_the_first_pilot_again() -> None:
    pilot, first, _ = pair()
    pilot.reset(2)
    seen = np.random.default_rng(0).normal(size=(20, 2, len(pilot.senses)))
    for observation in seen:
        pilot.act(observation)
    pilot.reset_boats(np.array([True, False]))
    scripted = ScriptedPilot(1)
    scripted.reset(2)
    scripted.reset_boats(np.array([True, False]))
    levers = pilot.act(seen[0])
    np.testing.assert_array_equal(levers[0], scripted.act(seen[0][:, first])[0])
    assert (levers[1] != scripted.act(seen[0][:, first])[1]).any()


def test_both_pilots_get_what_they_sense_and_nothing_twice() -> None:
    pilot, first, then = pair()
    assert len(set(pilot.senses)) == len(pilot.senses)
    assert [pilot.senses[i] for i in first] == list(pilot.first.senses)
    assert [pilot.senses[i] for i in then] == list(pilot.then.senses)
