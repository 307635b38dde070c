"""The faults of thesis 6.5 on the virtual vehicle: the other hull takes over within a second."""

import numpy as np
import pytest

from benchmarks.link.computer import LOST, PORT, STARBOARD, WISH_LASTS
from benchmarks.link.faults import FAULTS, NONE, WISH, Fault, meets, outcome_of
from benchmarks.link.pair import Pair
from swamp_rl.boat import load_boat
from swamp_rl.errors import UserError
from swamp_rl.link.network import Faults

BAR = 1.0
"""Seconds in which the commands and the jets must give the wished force again."""
LOSSY = Faults(loss=0.2, doubled=0.1, delay=(0.0, 0.03))


def after(fault: Fault) -> Pair:
    """A pair three seconds after a fault."""
    pair = under_way()
    fault.strike(pair)
    return sailed(pair, 3.0)


def under_way() -> Pair:
    """A pair whose jets give what the console wishes."""
    pair = Pair(load_boat("swamp"))
    pair.wish = WISH
    return sailed(pair, 2.0)


def sailed(pair: Pair, seconds: float) -> Pair:
    end = pair.time + seconds
    while pair.time < end - 1e-9:
        pair.step()
    return pair


def fault(name: str) -> Fault:
    return next(one for one in FAULTS if one.name == name)


@pytest.mark.parametrize("network", [Faults(), LOSSY], ids=["good network", "lossy network"])
@pytest.mark.parametrize("struck", FAULTS, ids=lambda one: one.name)
def test_the_wish_is_met_again_within_a_second(struck: Fault, network: Faults) -> None:
    found = outcome_of(struck, load_boat("swamp"), network, seed=1)
    assert found.commanded <= BAR and found.reached <= BAR
    assert (found.commanded == found.reached == 0.0) == (struck.consequence in (NONE, None))
    assert found.gps is not None and np.all(found.most > 0.0)


@pytest.mark.parametrize("hull", [STARBOARD, PORT])
def test_the_other_computer_commands_all_jets_of_one_that_died(hull: int) -> None:
    pair = under_way()
    pair.dead_computers.add(hull)
    sailed(pair, 1.0)
    assert pair.commanders == [1 - hull] * 4
    assert meets(pair.force())


def test_each_computer_commands_its_own_jets_otherwise() -> None:
    pair = under_way()
    assert dict(zip(pair.jets.names, pair.commanders, strict=True)) == {
        **dict.fromkeys(("bs", "ss"), STARBOARD),
        **dict.fromkeys(("bp", "sp"), PORT),
    }


def test_a_cut_link_between_the_hulls_changes_nothing_while_both_communicate() -> None:
    pair = after(fault("wireless link between the hulls"))
    assert meets(pair.force())
    assert pair.commanders == [STARBOARD, PORT, STARBOARD, PORT]


def test_a_hull_that_is_cut_off_from_everybody_stops_its_pumps() -> None:
    pair = under_way()
    pair.cut = True
    pair.dead_communications.add(PORT)
    sailed(pair, 3.0)
    commands = dict(zip(pair.jets.names, pair.vehicle.commands()[4:], strict=True))
    assert commands["bp"] == commands["sp"] == 0.0
    assert commands["bs"] > 0.0 and meets(pair.force())  # the hull that hears the console does it alone


def test_without_the_console_the_pumps_stop() -> None:
    pair = under_way()
    pair.dead_communications.update((STARBOARD, PORT))
    sailed(pair, WISH_LASTS + 0.3)
    assert not pair.vehicle.commands()[4:].any()


def test_the_other_hulls_gps_is_used_and_none_where_both_are_lost() -> None:
    pair = after(fault("GPS of the starboard hull"))
    assert [one.navigates_by(pair.time) for one in pair.computers] == [PORT, PORT]
    pair.vehicle.blind.update(pair.vehicle.addresses.sensors)
    sailed(pair, LOST + 0.2)
    assert [one.navigates_by(pair.time) for one in pair.computers] == [None, None]


def test_a_computer_that_comes_back_commands_its_own_jets_again() -> None:
    pair = after(fault("computer of the starboard hull"))
    pair.dead_computers.clear()
    sailed(pair, 1.5)
    assert pair.commanders == [STARBOARD, PORT, STARBOARD, PORT] and meets(pair.force())


def test_one_hull_alone_gives_a_third_of_the_surge_force() -> None:
    two = outcome_of(fault("two thrusters on one hull"), load_boat("swamp")).most
    four = outcome_of(fault("GPS of the port hull"), load_boat("swamp")).most
    # Each jet gives X/2 ahead and ±(y/2x) X abeam, which takes the moment away: T² = X²/4 (1 + (y/x)²).
    assert two[0] == pytest.approx(2.0 / np.hypot(1.0, 0.4 / 0.35) * four[0] / 4.0, rel=1e-3)


def test_a_boat_with_jets_on_one_side_is_refused() -> None:
    boat = load_boat("swamp")
    single = boat.model_copy(update={"thrusters": tuple(t for t in boat.thrusters if t.y > 0.0)})
    with pytest.raises(UserError, match="both sides"):
        Pair(single)
