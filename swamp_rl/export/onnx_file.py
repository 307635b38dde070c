"""Write a pilot's step as an ONNX file, and say how far it is from the step in NumPy."""

import json
from pathlib import Path

import numpy as np

from swamp_rl import __version__
from swamp_rl.export.graph import Graph
from swamp_rl.export.onnx_pilot import OnnxPilot
from swamp_rl.export.steps import seen_by, step
from swamp_rl.extras import missing
from swamp_rl.files import write_beside
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.seal import BLANK, KEY, sealed

STEPS = 100  # of the comparison with the file


def write_onnx(pilot: Pilot, path: Path | str, about: dict[str, str] | None = None) -> None:
    """Write the step of `pilot` to `path`; UserError where it has none in ONNX, or onnx is not installed.

    Inputs: `observation` (boats, d) in the order of the metadata's `senses`, SI units, and for each state
    `state_NAME`. Outputs: `levers` (boats, 2) and for each state `next_NAME`, to be given back at the next
    step. Every state is zeros at a run's start. about: more metadata. The file carries its SHA-256.
    """
    try:
        import onnx  # noqa: F401  needed by Graph
    except ImportError as error:
        raise missing("an ONNX file needs onnx", "onnx") from error
    graph = Graph()
    senses = seen_by(pilot)
    levers = step(pilot, graph, graph.input("observation", len(senses)))
    graph.output("levers", levers, 2)
    known = {"kind": pilot.kind, "senses": json.dumps(senses), "swamp_rl": __version__}
    model = graph.model(pilot.kind, known | (about or {}) | {KEY: BLANK})
    with write_beside(path) as part:
        part.write_bytes(sealed(model.SerializeToString()))


def greatest_difference(pilot: Pilot, path: Path | str, rng: np.random.Generator) -> float:
    """Greatest difference of any lever between `pilot` and its file over runs of 8 boats that see noise.

    Half of the boats begin anew half-way.
    """
    exported, boats = OnnxPilot(path), 8
    pilot.reset(boats)
    exported.reset(boats)
    places = [pilot.senses.index(name) for name in exported.senses]
    greatest = 0.0
    for i in range(STEPS):
        if i == STEPS // 2:
            again = np.arange(boats) % 2 == 0
            pilot.reset_boats(again)
            exported.reset_boats(again)
        observation = rng.normal(scale=2.0, size=(boats, len(pilot.senses)))
        levers = pilot.act(observation)
        # while a pilot outside the file drives, its levers are the input and must come out as they are
        outside = levers if exported.wants_first else None
        greatest = max(greatest, float(np.abs(levers - exported.act(observation[:, places], outside)).max()))
    return greatest
