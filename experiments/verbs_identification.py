"""`swamp-rl identify`: numbers of a boat from recorded runs, by the regressions of the papers."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from swamp_rl.boat import Boat
    from swamp_rl.identification.motion import Motion

identify_app = typer.Typer(
    help="Identify a boat from recorded runs, by the papers' regressions.", no_args_is_help=True
)

Folder = Annotated[Path, typer.Argument(help="A folder of runs.")]
BoatOption = Annotated[
    str | None, typer.Option("--boat", help="Another boat than the dataset's, or that of a plain folder.")
]
Smooth = Annotated[float, typer.Option(min=0.0, help="Span of a quadratic smoother, s; 0: none.")]


def _motion(folder: Path, name: str | None, smooth: float) -> tuple["Motion", "Boat"]:
    from swamp_rl.boat import load_boat
    from swamp_rl.identification.motion import motions_of
    from swamp_rl.runs import read_dataset

    dataset = read_dataset(folder, name)
    boat = load_boat(name) if name else dataset.boat
    return motions_of(dataset.runs, boat, smooth), boat


@identify_app.command("yaw-model")
def yaw_model(
    dataset: Folder,
    boat: BoatOption = None,
    smooth: Smooth = 0.0,
    inertia: Annotated[float | None, typer.Option(help="I_r, kg m2; by default the boat file's.")] = None,
) -> None:
    """k_r, c_ru, c_rv and b_r of the yaw model of paper 002, by pseudo-inverse and by rollout."""
    from swamp_rl.identification.yaw_model import NAMES, by_pseudo_inverse, by_rollout

    motion, known = _motion(dataset, boat, smooth)
    found, estimates = by_pseudo_inverse(motion, inertia or known.inertia_z)
    rolled = by_rollout(motion, found)
    for name, one, other in zip(NAMES, estimates, rolled[:4], strict=True):
        between = f"95 % {one.low:.4g} to {one.high:.4g}"
        typer.echo(f"{name:<5} {one.value:>9.4g} {one.unit:<8} {between:<30} by rollout {other:.4g}")
    pushing = motion.throttle[motion.throttle > 0.0]
    if len(pushing) and pushing.max() - pushing.min() > 0.05:
        low, high = pushing.min(), pushing.max()
        typer.echo(f"note: throttles from {low:.2f} to {high:.2f}; b_r holds for one, give runs of one")


@identify_app.command()
def elementary(dataset: Folder, boat: BoatOption = None, smooth: Smooth = 0.0) -> None:
    """Mass and quadratic drag of surge and yaw by paper 003's bounded least squares."""
    import numpy as np

    from swamp_rl.errors import UserError
    from swamp_rl.identification.elementary import expected, identify_surge, identify_yaw, surge_motion

    motion, known = _motion(dataset, boat, smooth)
    ahead = surge_motion(motion).velocity[:, 0]
    speed = float(np.sqrt(np.mean(ahead**2))) if ahead.any() else 0.7
    given = expected(known, speed)
    for name, identify in (("surge", identify_surge), ("yaw", identify_yaw)):
        try:
            found = identify(motion, known)
        except UserError as error:
            typer.echo(f"{name}: {error}")
            continue
        for what, one, file in zip(("mass", "drag"), found, given[name], strict=True):
            between = f"95 % {one.low:.4g} to {one.high:.4g}"
            at = f" at {speed:.2f} m/s" if (name, what) == ("surge", "drag") else ""
            typer.echo(
                f"{name:<5} {what} {one.value:>9.4g} {one.unit:<8} {between:<30} boat file {file:.4g}{at}"
            )


@identify_app.command("thrust-deduction")
def thrust_deduction(dataset: Folder, boat: BoatOption = None) -> None:
    """1 - t from the speed that each throttle reaches on straight runs (thesis eq. 7.3)."""
    from swamp_rl.errors import UserError
    from swamp_rl.identification.deduction import LEAST, SETTLE, deduction_points, paired

    motion, known = _motion(dataset, boat, 0.0)
    points = deduction_points(motion, known)
    if not points:
        raise UserError(
            f"{dataset}: no straight run at a constant throttle for {SETTLE + LEAST:g} s with the jets along "
            "the hull; record some, ahead and astern"
        )
    for one in points:
        way = "ahead" if one.ahead else "astern"
        typer.echo(
            f"throttle {one.throttle:.2f} {way:<6} {one.speed:+.3f} m/s over {one.seconds:.0f} s: "
            f"1 - t = {one.factor:.3f}, 95 % {one.low:.3f} to {one.high:.3f}"
        )
    for throttle, factor in paired(points, known).items():
        typer.echo(f"throttle {throttle:.2f} mean of all its directions: 1 - t = {factor:.3f}")
