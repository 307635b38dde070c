"""Options of every verb that does many jobs at once."""

from typing import Annotated

import typer

Workers = Annotated[
    int | None,
    typer.Option("--workers", min=1, max=1024, help="Processes at once; by default one for each processor."),
]
Ray = Annotated[
    str | None,
    typer.Option("--ray", metavar="ADDRESS", help="Use the Ray cluster there, such as 127.0.0.1:6379."),
]
