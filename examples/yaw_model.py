"""Identify the yaw model of Ferretti et al. from zig-zags, and simulate a turn with the boat it came from.

Prints k_r, c_ru, c_rv and b_r with their 95 % intervals, and the reason where the runs do not show a number.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import swamp_rl
from swamp_rl.runs import write_run

with TemporaryDirectory() as folder:
    for run, _ in swamp_rl.trial("zig-zag", boat="swamp-light", throttle=0.6, angle_deg=[10, 20, 30]):
        write_run(Path(folder, "zig_zags", f"{run.name}.csv"), run)
    numbers = swamp_rl.identify(Path(folder, "zig_zags"), "yaw-model", boat="swamp-light")

for number in numbers:
    print(f"{number.name}: {number.value:.2f} {number.unit}, {number.low:.2f} to {number.high:.2f}")
    if number.doubt:
        print(f"  not identified: {number.doubt}")
