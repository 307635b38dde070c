"""What goes wrong in a class of the user's own is told as theirs."""

import sys
from pathlib import Path

import numpy as np
import pytest

import swamp_rl
from swamp_rl.errors import UserError
from swamp_rl.own_code import fault_in_own_code
from swamp_rl.pilots import own
from swamp_rl.pilots.own import OwnPilot
from swamp_rl.pilots.settings import Settings
from swamp_rl.pilots.store import load_pilot, save_pilot
from tests.support.own_pilots import own_pilot_module


def named_pilot(folder: Path, monkeypatch: pytest.MonkeyPatch, load: str = "return cls()") -> OwnPilot:
    """A pilot of the class Ahead of a module that lies in `folder`."""
    (folder / "their_ahead.py").write_text(own_pilot_module(load=load))
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setattr(own, "_named", {})
    sys.modules.pop("their_ahead", None)
    found = own.own_class("their_ahead:Ahead")
    return OwnPilot("their_ahead:Ahead", found(), Settings())


@pytest.mark.parametrize("fault", ["ValueError('bad')", "KeyError('bad')", "RuntimeError('bad')"])
def test_a_fault_in_load_is_told_by_its_line_and_not_as_a_damage_of_the_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: str
) -> None:
    save_pilot(named_pilot(tmp_path, monkeypatch, f"raise {fault}"), tmp_path / "stored")
    with pytest.raises((ValueError, KeyError, RuntimeError)) as error:
        load_pilot(tmp_path / "stored")
    said = fault_in_own_code(error.value)
    assert said is not None and f"their_ahead.py, line 16: {fault.partition('(')[0]}: " in said


def test_the_name_that_a_refusal_advises_loads_the_pilot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "stored"
    save_pilot(named_pilot(tmp_path, monkeypatch), folder)
    monkeypatch.setattr(own, "_named", {})
    with pytest.raises(UserError, match=r"if it is yours, name it: their_ahead:Ahead=FOLDER$"):
        swamp_rl.load_pilot(folder)
    pilot = swamp_rl.load_pilot(f"their_ahead:Ahead={folder}")
    pilot.reset(1)
    assert pilot.act(np.zeros((1, 1))).tolist() == [[1.0, 0.0]]


def test_load_pilot_takes_built_in_pilots_and_refuses_what_is_no_name() -> None:
    assert swamp_rl.load_pilot("line-of-sight").kind == "line-of-sight"
    with pytest.raises(UserError, match="the type int was given; name a pilot or its folder"):
        swamp_rl.load_pilot(3)
    with pytest.raises(UserError, match=r"nowhere\.zip: No such file"):
        swamp_rl.load_pilot("sb3:nowhere.zip")
