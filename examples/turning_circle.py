"""Sail a turning circle, print its figures and draw the track.

Prints every figure of the manoeuvre with its unit; writes turning_circle.png into the working directory.
"""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt

import swamp_rl

((run, result),) = swamp_rl.trial("turning-circle", boat="swamp", throttle=0.6, angle_deg=30)

print(run.name)
for name, figure in result.figures.items():
    print(f"  {name}: {figure.value:.3g} {figure.unit}")

fig, axes = plt.subplots(figsize=(5, 5))
axes.plot(run.columns["east"], run.columns["north"])
axes.set(xlabel="east [m]", ylabel="north [m]", aspect="equal")
fig.savefig("turning_circle.png", dpi=120)
print("wrote turning_circle.png")
