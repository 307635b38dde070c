"""Options that several verbs have."""

from typing import Annotated, Any

import typer

BoatOption = Annotated[str, typer.Option("--boat", help="A name in configs/boats, or a boat file.")]
OwnBoatOption = Annotated[
    str | None,
    typer.Option(
        "--boat", help="Boat to use in place of the dataset's; needed for a folder without dataset.yaml."
    ),
]
CourseOption = Annotated[str, typer.Option("--course", help="A name in configs/courses, or a course file.")]
IgnoreOption = Annotated[
    list[str] | None,
    typer.Option("--ignore", help="Ignore a measured quantity, wind or depth; may be repeated."),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", min=1, max=1024, help="Processes at once; by default one for each processor."),
]
Ray = Annotated[
    str | None,
    typer.Option(
        "--ray", metavar="ADDRESS", help="Use the Ray cluster at this address, such as 127.0.0.1:6379."
    ),
]


def seed_option(help: str) -> Any:
    """The option of a seed; help: its help text."""
    return typer.Option(min=0, max=2**31 - 1, help=help)
