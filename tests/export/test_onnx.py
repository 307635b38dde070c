"""A pilot's step in an ONNX runtime is its step in NumPy."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest
from hypothesis import given, settings, strategies
from swamp_rl.experiments.cli.export import export

from swamp_rl.errors import UserError
from swamp_rl.export import OnnxPilot, greatest_difference, write_onnx
from swamp_rl.pilots import Pilot, save_pilot
from swamp_rl.pilots.reservoir import ReservoirPilot
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.store import describe_pilot
from swamp_rl.pilots.takeover import TakeoverPilot
from swamp_rl.seal import BLANK, KEY, sealed
from tests.support.random_pilots import SENSES, gru, network, reservoir


def pilots() -> dict[str, Pilot]:
    rng = np.random.default_rng(0)
    alone: dict[str, Pilot] = {
        "cloning": network(rng),
        "ppo": network(rng, hold=6),
        "reservoir": reservoir(rng),
    }
    alone["gru"] = gru(rng)
    alone["remembering ppo"] = network(rng, hold=5, memory=3)
    taken = TakeoverPilot(ScriptedPilot(5), reservoir(rng), 3.0)
    handed = TakeoverPilot(network(rng, hold=4), TakeoverPilot(reservoir(rng), network(rng, 3), 2.0), 1.0)
    return {**alone, "takeover": taken, "takeover of takeovers": handed}


@pytest.mark.parametrize("name", pilots())
def test_the_exported_step_is_the_numpy_step_to_the_last_digits(name: str, tmp_path: Path) -> None:
    pilot = pilots()[name]
    write_onnx(pilot, tmp_path / "pilot.onnx")
    exact = isinstance(pilot, ReservoirPilot) or name == "takeover"  # in double precision throughout
    limit = 1e-12 if exact else 1e-5
    assert greatest_difference(pilot, tmp_path / "pilot.onnx", np.random.default_rng(1)) < limit


def test_the_command_says_that_the_file_of_a_takeover_needs_another_pilot(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, said in (("takeover", True), ("reservoir", False)):
        save_pilot(pilots()[name], tmp_path / name)
        export(tmp_path / name, tmp_path / f"{name}.onnx")
        told = f"evaluate, helm and demo take {tmp_path / name}, not this file"
        assert (told in capsys.readouterr().out) is said


@settings(max_examples=10)
@given(
    seed=strategies.integers(0, 2**31),
    hold=strategies.integers(1, 9),
    memory=strategies.integers(0, 3),
    boats=strategies.integers(1, 5),
)
def test_any_network_holds_and_remembers_as_long_in_the_file(
    tmp_path_factory: pytest.TempPathFactory, seed: int, hold: int, memory: int, boats: int
) -> None:
    rng = np.random.default_rng(seed)
    pilot, path = network(rng, hold, memory), tmp_path_factory.mktemp("any") / "pilot.onnx"
    write_onnx(pilot, path)
    exported = OnnxPilot(path)
    pilot.reset(boats)
    exported.reset(boats)
    for _ in range(3 * hold):
        again = rng.random(boats) < 0.1
        pilot.reset_boats(again)
        exported.reset_boats(again)
        seen = rng.normal(size=(boats, 4))
        np.testing.assert_allclose(exported.act(seen), pilot.act(seen), atol=1e-5)


def test_while_a_person_drives_their_levers_come_out_and_then_the_learned_ones(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    learned = reservoir(rng)
    write_onnx(TakeoverPilot(ScriptedPilot(0), learned, 1.0), tmp_path / "pilot.onnx")
    exported = OnnxPilot(tmp_path / "pilot.onnx")
    assert exported.wants_first and exported.senses == SENSES
    exported.reset(2)
    learned.reset(2)
    person = np.array([[0.25, -0.75], [1.0, 0.5]])
    for tick in range(15):
        seen = rng.normal(size=(2, 4))
        watched = learned.act(seen)
        expected = person if tick < 10 else watched
        np.testing.assert_allclose(exported.act(seen, person), expected, atol=1e-12)


def test_the_file_passes_the_checker_and_says_what_it_senses(tmp_path: Path) -> None:
    write_onnx(pilots()["ppo"], tmp_path / "pilot.onnx", {"weights_sha256": "0" * 64})
    model = onnx.load(tmp_path / "pilot.onnx")
    onnx.checker.check_model(model, full_check=True)
    known = {entry.key: entry.value for entry in model.metadata_props}
    assert json.loads(known["senses"]) == list(SENSES)
    assert (known["kind"], known["weights_sha256"]) == ("ppo", "0" * 64)
    assert [given.name for given in model.graph.input] == ["observation", "state_held_for", "state_levers"]
    assert [given.name for given in model.graph.output] == ["next_held_for", "next_levers", "levers"]


def test_the_verb_exports_a_stored_pilot_and_says_how_near_and_how_fast_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save_pilot(pilots()["ppo"], tmp_path / "ppo")
    export(tmp_path / "ppo", tmp_path / "pilot.onnx")
    message = capsys.readouterr().out
    assert "greatest difference" in message and "µs" in message
    known = {entry.key: entry.value for entry in onnx.load(tmp_path / "pilot.onnx").metadata_props}
    assert known["weights_sha256"] == describe_pilot(tmp_path / "ppo").weights.sha256


def test_what_cannot_be_exported_is_said_in_one_line_and_leaves_no_file(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="draws its habits"):
        write_onnx(ScriptedPilot(0), tmp_path / "pilot.onnx")
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_no_exported_pilot_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "pilot.onnx"
    with pytest.raises(UserError, match="No such file"):
        OnnxPilot(path)
    path.write_bytes(b"no model")
    with pytest.raises(UserError, match="carries no checksum"):
        OnnxPilot(path)
    path.write_bytes(sealed(BLANK.encode()))
    with pytest.raises(UserError, match="is not an ONNX model"):
        OnnxPilot(path)
    one = onnx.helper.make_tensor_value_info("x", onnx.TensorProto.FLOAT, [1])
    two = onnx.helper.make_tensor_value_info("y", onnx.TensorProto.FLOAT, [1])
    graph = onnx.helper.make_graph([onnx.helper.make_node("Neg", ["x"], ["y"])], "other", [one], [two])
    opset = [onnx.helper.make_opsetid("", 17)]
    model = onnx.helper.make_model(graph, opset_imports=opset, ir_version=8)
    onnx.helper.set_model_props(model, {KEY: BLANK})
    path.write_bytes(sealed(model.SerializeToString()))
    with pytest.raises(UserError, match="is not the step of a pilot"):
        OnnxPilot(path)


def changed(path: Path, change: Callable[[onnx.ModelProto], None]) -> str:
    """Message for a file whose model was changed and sealed again, and for its step; empty if accepted."""
    write_onnx(gru(np.random.default_rng(0), 4), path)
    model = onnx.load(path)
    change(model)
    (seal,) = (entry for entry in model.metadata_props if entry.key == KEY)
    seal.value = BLANK
    path.write_bytes(sealed(model.SerializeToString()))
    try:
        pilot = OnnxPilot(path)
        pilot.reset(2)
        pilot.act(np.zeros((2, len(pilot.senses))))
    except UserError as error:
        return str(error)
    return ""


def without_output(name: str) -> Callable[[onnx.ModelProto], None]:
    def change(model: onnx.ModelProto) -> None:
        kept = [one for one in model.graph.output if one.name != name]
        del model.graph.output[:]
        model.graph.output.extend(kept)

    return change


def with_state_of(size: Any) -> Callable[[onnx.ModelProto], None]:
    def change(model: onnx.ModelProto) -> None:
        (state,) = (one for one in model.graph.input if one.name.startswith("state_"))
        dimension = state.type.tensor_type.shape.dim[1]
        dimension.Clear()
        setattr(dimension, "dim_param" if isinstance(size, str) else "dim_value", size)

    return change


def with_entry(key: str, text: str) -> Callable[[onnx.ModelProto], None]:
    def change(model: onnx.ModelProto) -> None:
        entries = {entry.key: entry.value for entry in model.metadata_props}
        onnx.helper.set_model_props(model, entries | {key: text})

    return change


def without_numbers(model: onnx.ModelProto) -> None:
    """Every constant that is a floating-point number becomes NaN."""
    for held in model.graph.initializer:
        array = onnx.numpy_helper.to_array(held)
        if array.dtype.kind == "f":
            held.CopyFrom(onnx.numpy_helper.from_array(np.full_like(array, np.nan), held.name))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda model: None, ""),
        (without_output("levers"), "is not the step of a pilot"),
        (without_output("next_memory"), "is not the step of a pilot"),
        (with_state_of("any"), "is not the step of a pilot"),
        (with_state_of(-1), "is not the step of a pilot"),
        (with_state_of(10**12), "is not an ONNX model"),
        (without_numbers, "does not compute two levers of each boat"),
        *(
            (with_entry("senses", text), "does not name its observations")
            for text in ("1", "{}", "[1]", "[null]", "x")
        ),
        *((with_entry("made", text), "does not name its boat and step") for text in ("", "1", "{}", "x")),
    ],
)
def test_a_changed_model_is_refused_in_one_line_and_the_runtime_says_nothing(
    change: Callable[[onnx.ModelProto], None],
    message: str,
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
) -> None:
    output = changed(tmp_path / "pilot.onnx", change)
    assert message in output and bool(message) == bool(output) and output.isprintable()
    assert capfd.readouterr() == ("", "")
