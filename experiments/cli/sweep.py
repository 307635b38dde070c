"""`swamp-rl sweep`: one experiment with many values of its parameters."""

from pathlib import Path
from typing import Annotated

import typer
from swamp_rl.experiments.cli.options import Ray, Workers


def sweep(
    file: Annotated[str, typer.Argument(metavar="SWEEP", help="A name in configs/sweeps, or a YAML file.")],
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Override a key of the experiment in every trial; may be repeated.",
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder, in place of results/sweeps/NAME.")] = None,
    workers: Workers = None,
    ray: Ray = None,
) -> None:
    """Run every trial of a sweep; the same command resumes an interrupted one."""
    from swamp_rl.experiments.sweep.run import run_sweep
    from swamp_rl.experiments.sweep.store import Trial

    def tell(trial: Trial, total: int) -> None:
        what = trial.error or ("no value" if trial.value is None else f"objective {trial.value:.4g}")
        if trial.summary is not None and trial.value != trial.summary["success_rate"]:
            what += f", success {100.0 * trial.summary['success_rate']:.3g} %"
        values = ", ".join(f"{key.split('.')[-1]} {value}" for key, value in trial.values.items())
        typer.echo(f"trial {trial.counted} of {total} ({values}): {what}")

    folder = run_sweep(file, set_ or [], out, workers, ray, tell)
    typer.echo(f"see {folder / 'sweep.md'}")
