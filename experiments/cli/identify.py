"""`swamp-rl identify`: numbers of a boat from recorded runs, by the regressions of the papers."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer
from swamp_rl.experiments.cli.options import OwnBoatOption

from swamp_rl.errors import UserError

if TYPE_CHECKING:
    from swamp_rl.boat import Boat
    from swamp_rl.identification.motion import Motion

identify_app = typer.Typer(
    help="Identify a boat from recorded runs: its whole file, or numbers by the papers' regressions.",
    no_args_is_help=True,
)

Folder = Annotated[Path, typer.Argument(help="A folder of runs.")]
Smooth = Annotated[
    float, typer.Option(min=0.0, max=3600.0, help="Span of the quadratic smoother (s); 0: no smoothing.")
]


def _motion(folder: Path, name: str | None, smooth: float) -> tuple["Motion", "Boat"]:
    from swamp_rl.boat import load_boat
    from swamp_rl.identification.motion import motions_of
    from swamp_rl.runs import read_dataset

    dataset = read_dataset(folder, name)
    boat = load_boat(name) if name else dataset.boat
    return motions_of(dataset.runs, boat, smooth), boat


class Line(NamedTuple):
    """A number to print: label, text, why the data do not show it (None where they do), what to record."""

    label: str
    text: str
    doubt: str | None
    needed: str


def _print(found: Sequence[Line], dataset: Path) -> None:
    """A line for each number, or for why it is refused; UserError, on one line, where all are."""
    if all(line.doubt for line in found):
        needs = dict.fromkeys(line.needed for line in found)
        parts = [
            ", ".join(f"{line.label}: {line.doubt}" for line in found if line.needed == needed)
            + f"; record {needed}"
            for needed in needs
        ]
        raise UserError(f"{dataset}: nothing can be identified; {'; '.join(parts)}")
    for line in found:
        refused = f"{line.label:<5} not identifiable: {line.doubt}; record {line.needed}"
        typer.echo(f"{line.label:<5} {line.text}" if line.doubt is None else refused)


@identify_app.command("yaw-model")
def yaw_model(
    dataset: Folder,
    boat: OwnBoatOption = None,
    smooth: Smooth = 0.0,
    inertia: Annotated[
        float | None,
        typer.Option(
            min=1e-6, max=1e9, help="Yaw moment of inertia I_r (kg m2); by default the boat file's."
        ),
    ] = None,
) -> None:
    """k_r, c_ru, c_rv and b_r of the yaw model of paper 002, by pseudo-inverse and by rollout."""
    from swamp_rl.identification.yaw_model import (
        NAMES,
        NEEDED,
        by_pseudo_inverse,
        by_rollout,
        yaw_model_doubts,
    )

    motion, known = _motion(dataset, boat, smooth)
    try:
        found, estimates = by_pseudo_inverse(motion, inertia or known.inertia_z)
        rolled = by_rollout(motion, found)
    except UserError as error:
        raise UserError(f"{dataset}: {error}") from error
    doubts = yaw_model_doubts(motion, estimates)
    lines = []
    for name, one, other, why in zip(NAMES, estimates, rolled[:4], doubts, strict=True):
        between = f"95 % {one.low:.4g} to {one.high:.4g}"
        text = f"{one.value:>9.4g} {one.unit:<8} {between:<30} rollout {other:.4g}"
        lines.append(Line(name, text, why, NEEDED))
    _print(lines, dataset)
    pushing = motion.throttle[motion.throttle > 0.0]
    if len(pushing) and pushing.max() - pushing.min() > 0.05:
        low, high = pushing.min(), pushing.max()
        typer.echo(
            f"note: throttles from {low:.2f} to {high:.2f}; b_r holds for one; use runs at one throttle"
        )


@identify_app.command()
def elementary(dataset: Folder, boat: OwnBoatOption = None, smooth: Smooth = 0.0) -> None:
    """Mass and quadratic drag of surge and yaw by paper 003's bounded least squares."""
    import numpy as np

    from swamp_rl.identification.elementary import (
        NAMES,
        NEEDED,
        expected,
        identify_surge,
        identify_yaw,
        lacking,
        surge_doubts,
        surge_motion,
        yaw_doubts,
    )

    motion, known = _motion(dataset, boat, smooth)
    ahead = surge_motion(motion).velocity[:, 0]
    speed = float(np.sqrt(np.mean(ahead**2))) if ahead.any() else 0.7
    given = expected(known, speed)
    axes = {"surge": (identify_surge, surge_doubts), "yaw": (identify_yaw, yaw_doubts)}
    lines = []
    for name, (identify, doubts) in axes.items():
        if why := lacking(motion, name):
            lines.append(Line(name, "", f"no elementary motion, {why}", NEEDED[name]))
            continue
        found = identify(motion, known)
        for what, one, why, file in zip(NAMES, found, doubts(motion, found), given[name], strict=True):
            at = f" at {speed:.2f} m/s" if (name, what) == ("surge", "drag") else ""
            between = f"95 % {one.low:.4g} to {one.high:.4g}"
            text = f"{one.value:>9.4g} {one.unit:<8} {between:<30} boat file {file:.4g}{at}"
            lines.append(Line(f"{name:<5} {what}", text, why, NEEDED[name]))
    _print(lines, dataset)


@identify_app.command("thrust-deduction")
def thrust_deduction(dataset: Folder, boat: OwnBoatOption = None) -> None:
    """Thrust deduction 1 - t from the steady speed at each throttle on straight runs (thesis eq. 7.3)."""
    from swamp_rl.identification.deduction import LEAST, SETTLE, deduction_points, paired, point_doubt

    needed = "straight runs of a steady speed, ahead and astern"
    motion, known = _motion(dataset, boat, 0.0)
    points = deduction_points(motion, known)
    if not points:
        raise UserError(
            f"{dataset}: no straight run at a constant throttle for {SETTLE + LEAST:g} s with the jets along "
            f"the hull; record {needed}"
        )
    lines = []
    for one in points:
        text = (
            f"{one.speed:+.3f} m/s over {one.seconds:.0f} s: "
            f"1 - t = {one.factor:.3f}, 95 % {one.low:.3f} to {one.high:.3f}"
        )
        label = f"throttle {one.throttle:.2f} {'ahead' if one.ahead else 'astern':<6}"
        lines.append(Line(label, text, point_doubt(one, known), needed))
    _print(lines, dataset)
    shown = [one for one, line in zip(points, lines, strict=True) if line.doubt is None]
    for throttle, factor in paired(shown, known).items():
        typer.echo(f"throttle {throttle:.2f} mean of all its directions: 1 - t = {factor:.3f}")
    if len({one.ahead for one in shown}) == 1:
        typer.echo(f"note: a current along the course shifts 1 - t unseen; record {needed}")
