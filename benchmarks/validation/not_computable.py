"""Printed numbers whose input the sources do not print: a table of docs/validation.md."""

from swamp_rl.experiments.reports.experiment import table

from benchmarks.validation.hull import FULL_MASS
from benchmarks.validation.swamp import deduction_rows, yaw_rows
from swamp_rl.constants import KNOT
from swamp_rl.design.hull_lines import load_hull
from swamp_rl.design.hydrostatics import draught_of, hydrostatics
from swamp_rl.design.matching import best_ranges, load_match
from swamp_rl.identification.yaw_model import NAMES

HEAD = ["number", "source", "printed", "not printed", "nearest of ours"]
RESERVE = 70.0  # kg, table 4.1


def not_computable_table() -> str:
    """Every such number, what a computation of it lacks, and what comes nearest to it here."""
    return table(HEAD, [*sea_trials(), *hull_and_tank(), *typhoon()])


def sea_trials() -> list[list[str]]:
    """What 002 and 7.3.5 work out from runs that are pictures only."""
    published, *_, rollout = yaw_rows()
    printed = "; ".join(f"{name} {getattr(published.model, name):.2f}" for name in NAMES)
    ours = "; ".join(f"{getattr(rollout.model, name):.2f}" for name in NAMES)
    factors = {percent: factor for percent, _, factor in deduction_rows()}
    fitted = f"{ours}, fitted to simulated runs"
    speeds = "the speeds of figure 7.54, of trials in waves"
    return [
        ["coefficients of the yaw model", "002, table III", printed, "the logs of the runs", fitted],
        ["1 − t, low RPM", "7.3.5", "around 0.3", speeds, f"{factors[30]:.2f}, simulated at 30 %"],
        ["1 − t, around the design RPM", "7.3.5", "0.75", speeds, f"{factors[100]:.2f}, simulated at 100 %"],
    ]


def hull_and_tank() -> list[list[str]]:
    """What the thesis measures or states without a rule to work it out by."""
    hull = load_hull("swamp_hull")
    reserve = hydrostatics(hull, hull.depth).mass - FULL_MASS
    level = 1e3 * draught_of(hull, FULL_MASS + RESERVE)
    ours = f"{reserve:.0f} kg above 58 kg, up to the height of 400 mm; 70 kg, up to {level:.0f} mm"
    return [
        [
            "reserve of buoyancy",
            "table 4.1",
            f"{RESERVE:g} kg",
            "the load and the height that it counts",
            ours,
        ],
        ["squat, 28 points", "table 4.7", "−0.41 to 84.82 mm", "a formula", "[ICORELS](#squat)"],
        ["sinkage and trim, 56 points", "table 4.7", "measured", "a formula", "–"],
        ["hydrodynamic derivatives", "8.1.3", "seven numbers", "the regressions that they are from", "–"],
        ["data of four INSEAN hulls and two variants", "tables 4.8, 4.9", "tables", "their lines", "–"],
    ]


def typhoon() -> list[list[str]]:
    """What 003 and 004 print of the Typhoon without its input."""
    design = load_match("typhoon_cfd")
    speeds = [f"{one.speed / KNOT:.2f}" for one in best_ranges(design)]
    side = 1230.0 / (1025.0 * 3.3 * 0.33)
    return [
        [
            "speed of best range with 50 and with 200 W on board",
            "004, figures 34, 35",
            "3 to 5 kn",
            "the efficiency of the propulsion",
            f"{speeds[0]} and {speeds[1]} kn at an assumed {design.efficiency:g}",
        ],
        [
            "C_DZ of D_33",
            "003, IV",
            "1.09",
            "its reference area",
            f"{2.0 * side:.2f} on L D with 004's 3.3 m and 0.33 m, {side:.2f} without the ½ of (1)",
        ],
        ["C_DX at 1 kn and at 6 kn", "003, IV", "0.1; 0.08", "the correlation of its reference 35", "–"],
        ["Reynolds numbers", "004, table 2", "four numbers", "the viscosity and the length", "–"],
        ["W_e/q³ and W_e/r³", "004", "250; 140 W s³", "the drag and the thrusters' curves", "–"],
        ["torque of the magnetic joint", "004, table 4", "three numbers", "the magnets and the mesh", "–"],
    ]
