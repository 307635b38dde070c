"""`swamp-rl run`, `train` and `evaluate`: a whole experiment, its training, or its evaluation."""

from pathlib import Path
from typing import Annotated

import typer
from swamp_rl.experiments.cli.options import seed_option

ExperimentName = Annotated[
    str,
    typer.Argument(help="A name in configs/experiments, a YAML file, or a folder of results to repeat."),
]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Override a key of the file, as in evaluation.episodes=100; may be repeated.",
    ),
]
Out = Annotated[Path | None, typer.Option(help="Folder of results, in place of results/NAME.")]


def run(experiment: ExperimentName, set_: Set = None, out: Out = None) -> None:
    """Train, evaluate and report the pilots of an experiment's YAML file."""
    from swamp_rl.experiments.studies.run import run_experiment

    run_experiment(experiment, set_ or [], out)


def train(
    experiment: ExperimentName,
    only: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PILOT", help="Train this pilot and those that it starts from; may be repeated."
        ),
    ] = None,
    set_: Set = None,
    out: Out = None,
) -> None:
    """Train an experiment's pilots, to be evaluated later by `evaluate` or `run`."""
    from swamp_rl.experiments.studies.run import train_experiment

    train_experiment(experiment, set_ or [], out, only)


def evaluate(
    sources: Annotated[
        list[str],
        typer.Argument(
            help="Folders of trained experiments or of single pilots in them, sb3:MODEL.zip, "
            "onnx:PILOT.onnx, MODULE:CLASS, or MODULE:CLASS=FOLDER for a folder of pilots of your own class."
        ),
    ],
    level: Annotated[
        list[str] | None, typer.Option(help="Disturbance level, in place of the file's; may be repeated.")
    ] = None,
    episodes: Annotated[
        int | None, typer.Option(min=1, max=100_000, help="Number of episodes at each level.")
    ] = None,
    seed: Annotated[int | None, seed_option("Seed of the first episode.")] = None,
    experiment: Annotated[
        str | None,
        typer.Option(
            help="Experiment that gives boat, course and levels; by default the first folder's, or camogli "
            "if no folder is named."
        ),
    ] = None,
    set_: Set = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder of results; by default FOLDER itself, or beside it.")
    ] = None,
) -> None:
    """Evaluate trained pilots, all in the same episodes, and report."""
    from swamp_rl.experiments.studies.stored import evaluate_folders

    asked = {"levels": level, "episodes": episodes, "seed": seed}
    changes = {key: value for key, value in asked.items() if value not in (None, [])}
    evaluate_folders(sources, changes, set_ or [], out, experiment)
