"""Export a pilot's step as ONNX and drive a boat from that file with onnxruntime.

Nothing of the pilot's own code is used while driving: the file holds the step, and its metadata the names of
what it observes. Needs the extra `onnx`. Prints inputs, the greatest difference of a lever, and the outcome.
"""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

import gymnasium
import numpy as np
import onnxruntime

import swamp_rl
from swamp_rl.export import greatest_difference, write_onnx

with TemporaryDirectory() as folder:
    settings = ["data.record.good=20", "data.record.failed=0"]
    trained = swamp_rl.train("camogli", settings, out=Path(folder, "out"), only=["reservoir-alone"])
    pilot = swamp_rl.load_pilot(trained / "pilots" / "reservoir-alone")
    file = Path(folder, "pilot.onnx")
    write_onnx(pilot, file)
    print(f"greatest difference: {greatest_difference(pilot, file, np.random.default_rng(0)):.0e}")
    session = onnxruntime.InferenceSession(file.read_bytes(), providers=["CPUExecutionProvider"])

senses = json.loads(session.get_modelmeta().custom_metadata_map["senses"])
inputs = [given.name for given in session.get_inputs()]
outputs = [out.name for out in session.get_outputs()]
print(f"inputs {inputs}, outputs {outputs}")

env = gymnasium.make("swamp/Gates-v1", observation=senses)
observation, info = env.reset(seed=3)
states = {
    given.name: np.zeros((1, given.shape[1])) for given in session.get_inputs() if given.name != "observation"
}
over = False
while not over:
    seen = {"observation": observation[None].astype(np.float64), **states}
    results = dict(zip(outputs, session.run(None, seen), strict=True))
    states = {name: results[name.replace("state_", "next_")] for name in states}
    observation, _, terminated, truncated, info = env.step(results["levers"][0])
    over = terminated or truncated
print(f"{info['outcome']} after {info['time']:.1f} s")
