"""`swamp-rl export`: a stored pilot's step as an ONNX file."""

from pathlib import Path
from typing import Annotated

import typer
from swamp_rl.experiments.cli.outputs import refuse_suffix


def export(
    pilot: Annotated[Path, typer.Argument(help="The folder of a pilot, such as results/camogli/pilots/ppo.")],
    out: Annotated[Path, typer.Option(help="The ONNX file to write.")] = Path("pilot.onnx"),
) -> None:
    """Write a pilot's step as ONNX; compare its actions and its run time with NumPy's."""
    import numpy as np

    from swamp_rl.errors import UserError
    from swamp_rl.export import OnnxPilot, greatest_difference, write_onnx
    from swamp_rl.export.onnx_pilot import MADE
    from swamp_rl.export.timing import step_microseconds
    from swamp_rl.pilots.arguments import asked_pilot
    from swamp_rl.pilots.store import describe_pilot, load_pilot

    refuse_suffix("--out", out, ".onnx")
    folder = asked_pilot(str(pilot)).folder
    if folder is None:
        raise UserError(f"{pilot}: only a stored pilot can be exported; name its folder")
    description, loaded = describe_pilot(folder), load_pilot(folder)
    about = {"weights_sha256": description.weights.sha256}
    if description.fitted_on is not None:
        about["fitted_on"] = description.fitted_on.model_dump_json()
    if description.made is not None:
        about[MADE] = description.made.model_dump_json()
    write_onnx(loaded, out, about)
    rng = np.random.default_rng(0)
    difference = greatest_difference(loaded, out, rng)
    typer.echo(f"{out}: greatest difference of an action from NumPy's {difference:.1e}")
    exported = OnnxPilot(out)
    if exported.wants_first:
        typer.echo(
            f"{out}: takes over from another pilot, whose actions are its input first_levers until then; "
            f"evaluate, helm and demo take {folder}, not this file"
        )
    exported.reset(1)
    loaded.reset(1)
    first = np.zeros((1, 2)) if exported.wants_first else None
    times = (
        step_microseconds(loaded.act, len(loaded.senses), rng),
        step_microseconds(lambda seen: exported.act(seen, first), len(exported.senses), rng),
    )
    typer.echo(f"one step of one boat: {times[0]:.0f} µs in NumPy, {times[1]:.0f} µs in onnxruntime")
