"""Clone a driver with a neural network, and compare it with the driver in the same episodes.

An experiment is one YAML file; here it is written, trained and evaluated from Python. Prints the success of
both pilots at each level of disturbance; the folder of results holds the report and its figures.
"""

import json
from pathlib import Path

import swamp_rl

EXPERIMENT = """
name: clone
boat: swamp
course: camogli
data: {record: {good: 10, failed: 0, disturbances: standard}}
pilots:
  scripted: {kind: scripted}
  cloning: {kind: cloning, options: {epochs: 20}}
evaluation: {levels: [calm, standard], episodes: 50, seed: 1000, shown: 5}
"""

folder = Path("results/example_clone")
folder.parent.mkdir(exist_ok=True)
file = folder.with_suffix(".yaml")
file.write_text(EXPERIMENT)
swamp_rl.run_experiment(file, out=folder)

results = json.loads((folder / "results.json").read_text())
for name, pilot in results["pilots"].items():
    for level, measured in pilot["levels"].items():
        low, high = measured["wilson_95"]
        print(f"{name}, {level}: {measured['success_rate']:.0%} ({low:.0%} to {high:.0%})")
print(f"report: {folder / 'report.md'}")
