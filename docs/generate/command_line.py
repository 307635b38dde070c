"""The reference of the command line, from the verbs themselves."""

import typer
from swamp_rl.experiments.cli.app import app
from swamp_rl.experiments.cli.help import PANELS
from typer.cli import get_docs_for_click

NAME = "swamp-rl"


def command_line() -> str:
    """A section for each verb, in the groups of `swamp-rl --help`."""
    whole = typer.main.get_command(app)
    context = typer.Context(whole, info_name=NAME)
    parts = []
    for panel in dict.fromkeys(PANELS.values()):
        parts.append(f"## {panel}\n")
        for verb in (verb for verb, of in PANELS.items() if of == panel):
            parts.append(_section(context, whole.get_command(context, verb), NAME))
    return "\n".join(parts)


def _section(context: typer.Context, verb, above: str) -> str:
    """Typer's own page of a verb, and of the verbs in it; the example as a command."""
    inner = getattr(verb, "commands", None)
    if inner:
        sections = [_section(context, one, f"{above} {verb.name}") for one in inner.values()]
        return "\n".join([f"### {above} {verb.name}\n", f"{verb.help}\n", *sections])
    page = get_docs_for_click(
        obj=verb, ctx=context, indent=2, call_prefix=above, title=f"{above} {verb.name}"
    )
    if not verb.epilog:
        return page
    command = verb.epilog.removeprefix("Example: ")
    return page.replace(f"{verb.epilog}\n", f"**Example**:\n\n```console\n$ {command}\n```\n")
