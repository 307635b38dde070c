"""What a recording says in words: who is shown in what weather, and the end card, as Markdown."""

import re

from swamp_rl.demo.card import HEAD, card
from swamp_rl.demo.scene import DemoScene


def about(scene: DemoScene) -> str:
    """The title and the scene's own line."""
    return f"**{plain(scene.title)}**: {plain(scene.about)}"


def table(scene: DemoScene) -> str:
    """The end card."""
    rows = [[f"{name} [{unit}]" if unit else name for name, unit in HEAD], ["---"] * len(HEAD)]
    rows += [[plain(cell) for cell in line.cells] for line in card(scene)]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def plain(text: str) -> str:
    """A name that Markdown shows as it is, whatever it holds, in one line."""
    return re.sub(r"([^\w\s,;:.])", r"\\\1", " ".join(text.split()))
