"""Hide an effect in a simulated boat, log a manoeuvre, and have the diagnosis name it.

The true boat's port bow jet pushes with 70 % of its thrust; the boat file given to the diagnosis does not say
so. Prints the verdict, the cause with its standard error, and the extended boat file.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import swamp_rl
from swamp_rl.runs import write_run

TRUE_BOAT = """
extends: swamp
effects:
  - {effect: thruster_gain, thruster: bp, gain: 0.7}
"""

with TemporaryDirectory() as folder:
    home = Path(folder)
    (home / "true.yaml").write_text(TRUE_BOAT)
    for throttle in (0.4, 0.8):  # at one throttle a weak jet and a dead band are alike
        for run, _ in swamp_rl.trial("zig-zag", boat=home / "true.yaml", throttle=throttle, angle_deg=20):
            write_run(home / "logs" / f"{run.name}.csv", run)

    found = swamp_rl.diagnose(home / "logs", "swamp", home / "diagnosis")
    print(f"verdict: {found.verdict}")
    for cause in found.causes:
        for name, estimate in cause.parameters.items():
            number = f"{estimate.value:.3f} ± {estimate.standard_error:.3f}"
            print(f"  {cause.effect} {cause.thruster}: {name} {number}")
    print((home / "diagnosis" / "extended_boat.yaml").read_text())
