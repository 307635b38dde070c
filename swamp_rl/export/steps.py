"""The step of each kind of pilot in ONNX operators, equal to its `act` in NumPy."""

from functools import singledispatch
from typing import Any

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.export.graph import Graph
from swamp_rl.pilots.arrays import Array
from swamp_rl.pilots.gru import GRUPilot
from swamp_rl.pilots.memory import LEVERS
from swamp_rl.pilots.network import REACH, NetworkPilot
from swamp_rl.pilots.reservoir import ReservoirPilot
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.takeover import TakeoverPilot

FIRST_LEVERS = "first_levers"
"Input of a takeover whose first pilot is not in the graph: the levers (n, 2) of whoever drives first."


@singledispatch
def step(pilot: Any, graph: Graph, observation: str, prefix: str = "") -> str:
    """Add the pilot's step to the graph: levers (n, 2) from the observation (n, d), and its states.

    prefix: before the names of its states. UserError for a pilot that has no step in ONNX.
    """
    raise UserError(f"a pilot of the kind {pilot.kind} has no step in ONNX; export another kind")


@step.register
def _(pilot: ScriptedPilot, graph: Graph, observation: str, prefix: str = "") -> str:
    raise UserError(
        "the scripted pilot draws its habits from NumPy's random generator, which ONNX has not; "
        "export a pilot that learned"
    )


@step.register
def _(pilot: NetworkPilot, graph: Graph, observation: str, prefix: str = "") -> str:
    settings = pilot.settings()
    hold, depth = settings["hold"], settings["memory"]
    due = _due(hold, graph, prefix)
    if not depth:
        return _held(_decided(pilot, graph, observation), due, graph, prefix)
    one = len(pilot.senses) + LEVERS
    past, known = graph.state(f"{prefix}past", depth * one), graph.state(f"{prefix}known", None, np.int64)
    remembered = _remembered(graph, observation, past, known, depth)
    decided = _decided(pilot, graph, graph.op("Concat", observation, remembered, axis=1))
    older = graph.choose(remembered, list(range((depth - 1) * one)))
    later = graph.op("Concat", observation, decided, older, axis=1)
    graph.keep(f"{prefix}past", later if due is None else graph.op("Where", due, later, past), depth * one)
    # a boat that has driven one step has decided once, for it decides at its first
    sure = graph.op("Max", known, graph.constant(1, np.int64))
    graph.keep(f"{prefix}known", sure, None, np.int64)
    return _held(decided, due, graph, prefix)


def _decided(pilot: NetworkPilot, graph: Graph, recalled: str) -> str:
    """Levers (n, 2) from what the layers are given."""
    weights = pilot.weights()
    x = _scaled(graph, recalled, weights)
    layers = sum(name.startswith("weight_") for name in weights)
    for i in range(layers):
        x = graph.op("MatMul", x, graph.constant(weights[f"weight_{i}"], np.float32))
        x = graph.op("Add", x, graph.constant(weights[f"bias_{i}"], np.float32))
        x = graph.op("Tanh", x) if i < layers - 1 else x
    return graph.within_reach(graph.cast(x, np.float64))


def _scaled(graph: Graph, seen: str, weights: dict[str, Array]) -> str:
    """In standard deviations from the mean, held within reach, in single precision."""
    mean, scale = graph.constant(weights["mean"]), graph.constant(weights["scale"])
    x = graph.op("Div", graph.op("Sub", seen, mean), scale)
    x = graph.op("Min", graph.op("Max", x, graph.constant(-REACH)), graph.constant(REACH))
    return graph.cast(x, np.float32)


def _remembered(graph: Graph, observation: str, past: str, known: str, depth: int) -> str:
    """The past (n, depth (d + 2)); of a boat that begins, its observation and levers at nought instead."""
    idle = graph.op("Pad", observation, graph.constant([0, 0, 0, LEVERS], np.int64))
    blank = graph.op("Tile", idle, graph.constant([1, depth], np.int64))
    begun = graph.column(graph.op("Greater", known, graph.constant(0, np.int64)))
    return graph.op("Where", begun, past, blank)


def _due(hold: int, graph: Graph, prefix: str) -> str | None:
    """Whether a boat decides at this step (n, 1); None where every one does."""
    if hold == 1:
        return None
    held_for = graph.state(f"{prefix}held_for", None, np.int64)
    later = graph.op("Add", held_for, graph.constant(1, np.int64))
    graph.keep(f"{prefix}held_for", graph.op("Mod", later, graph.constant(hold, np.int64)), None, np.int64)
    return graph.column(graph.op("Equal", held_for, graph.constant(0, np.int64)))


def _held(decided: str, due: str | None, graph: Graph, prefix: str) -> str:
    """Levers (n, 2): decided now where it is due, else those of an earlier step."""
    if due is None:
        return decided
    levers = graph.op("Where", due, decided, graph.state(f"{prefix}levers", 2))
    graph.keep(f"{prefix}levers", levers, 2)
    return levers


@step.register
def _(pilot: GRUPilot, graph: Graph, observation: str, prefix: str = "") -> str:
    w = {name: graph.constant(value, np.float32) for name, value in pilot.weights().items()}
    units = len(pilot.weights()["Wout"])
    memory = graph.state(f"{prefix}memory", units, np.float32)
    x = _scaled(graph, observation, pilot.weights())
    heard = graph.op("Add", graph.op("MatMul", x, w["input"]), w["input_bias"])
    recalled = graph.op("Add", graph.op("MatMul", memory, w["recurrent"]), w["recurrent_bias"])

    def part(value: str, third: int) -> str:
        return graph.choose(value, list(range(third * units, (third + 1) * units)))

    reset, update = (
        graph.op("Sigmoid", graph.op("Add", part(heard, third), part(recalled, third))) for third in (0, 1)
    )
    allowed = graph.op("Mul", reset, part(recalled, 2))
    candidate = graph.op("Tanh", graph.op("Add", part(heard, 2), allowed))
    left = graph.op("Mul", update, graph.op("Sub", memory, candidate))
    memory = graph.op("Add", candidate, left)
    graph.keep(f"{prefix}memory", memory, units, np.float32)
    levers = graph.op("Add", graph.op("MatMul", memory, w["Wout"]), w["out"])
    return graph.within_reach(graph.cast(levers, np.float64))


@step.register
def _(pilot: ReservoirPilot, graph: Graph, observation: str, prefix: str = "") -> str:
    w = pilot.weights()
    units, name = len(w["bias"]), f"{prefix}units"
    state = graph.state(name, units)
    seen = graph.op(
        "Div", graph.op("Sub", observation, graph.constant(w["centre"])), graph.constant(w["scale"])
    )
    drive = graph.op("Add", graph.op("MatMul", state, graph.constant(w["W"].T)), graph.constant(w["bias"]))
    drive = graph.op("Tanh", graph.op("Add", drive, graph.op("MatMul", seen, graph.constant(w["Win"].T))))
    change = graph.op("Mul", graph.op("Sub", drive, state), graph.constant(w["leak"]))
    state = graph.op("Add", state, change)
    graph.keep(name, state, units)
    levers = graph.op("MatMul", state, graph.constant(w["Wout"]))
    return graph.within_reach(graph.op("Add", levers, graph.constant(w["out"])))


@step.register
def _(pilot: TakeoverPilot, graph: Graph, observation: str, prefix: str = "") -> str:
    """Of a scripted first pilot only its levers are known, which are an input."""
    places = {name: i for i, name in enumerate(seen_by(pilot))}

    def of(one: Any) -> str:
        return graph.choose(observation, [places[name] for name in one.senses])

    watched = step(pilot.then, graph, of(pilot.then), f"{prefix}then_")
    if isinstance(pilot.first, ScriptedPilot):
        driven = graph.input(prefix + FIRST_LEVERS, 2)
    else:
        driven = step(pilot.first, graph, of(pilot.first), f"{prefix}first_")
    tick = graph.state(f"{prefix}tick", None, np.int64)
    early = graph.column(graph.op("Less", tick, graph.constant(round(pilot.seconds / pilot.step), np.int64)))
    graph.keep(f"{prefix}tick", graph.op("Add", tick, graph.constant(1, np.int64)), None, np.int64)
    return graph.op("Where", early, driven, watched)


def seen_by(pilot: Any) -> tuple[str, ...]:
    """Names of the d observations that the graph wants, in order: all but those of a first pilot left out."""
    left_out = isinstance(pilot, TakeoverPilot) and isinstance(pilot.first, ScriptedPilot)
    return seen_by(pilot.then) if left_out else tuple(pilot.senses)
