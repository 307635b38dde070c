"""What a film shows over its charts: wind and current with their speeds, and the end card."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np

from swamp_rl.demo.card import HEAD, card
from swamp_rl.demo.clock import Array
from swamp_rl.demo.colours import fractions
from swamp_rl.demo.scene import DemoScene, Shown
from swamp_rl.demo.weather import INK, flows

Moving = tuple[Any, Any, Callable[[int], None]]
"""Axes, artist, and what brings it to the i-th time."""
DRAWN = 11.0
"Half the length of an arrow [pixels]; the speed is written beside it."
LINE = 1.9
"Height of a line of text, in its font's sizes."
PAPER = "#fbfcfd"
SHARES = (0.24, 0.2, 0.1, 0.1, 0.19, 0.17)
"Of the card's width, for each column."


def weather(axes: Any, scene: DemoScene, shown: Sequence[Shown], times: Array) -> Iterator[Moving]:
    """A line in the lower right corner for each wind and current that the boats meet."""
    from matplotlib.patches import FancyArrowPatch
    from matplotlib.patheffects import withStroke
    from matplotlib.transforms import IdentityTransform

    edge = [withStroke(linewidth=2.0, foreground="white")]
    box, height = axes.get_window_extent(), _pixels(axes.figure) * LINE
    for row, flow in enumerate(reversed(flows(scene, shown, times))):
        speed, angle = np.hypot(*flow.towards.T), np.arctan2(*flow.towards.T)
        middle = np.array([box.x1 - 2.0 * DRAWN, box.y0 + (row + 1.0) * height])
        tips = DRAWN * np.column_stack([np.cos(angle), np.sin(angle)])
        colour = fractions(INK[flow.name])
        label = axes.text(
            middle[0] - 1.8 * DRAWN,
            middle[1],
            "",
            color=colour,
            ha="right",
            va="center",
            path_effects=edge,
            transform=IdentityTransform(),
            animated=True,
            parse_math=False,
        )
        arrow = FancyArrowPatch(
            tuple(middle),
            tuple(middle),
            arrowstyle="-|>",
            mutation_scale=11,
            color=colour,
            lw=1.8,
            shrinkA=0,
            shrinkB=0,
            transform=IdentityTransform(),
            animated=True,
        )
        axes.add_patch(arrow)
        whose = f"{flow.whose}: " if flow.whose else ""
        digits = 1 if flow.name == "wind" else 2

        lines = [f"{whose}{flow.name} {one:.{digits}f} m/s" for one in speed]
        yield axes, label, partial(_tell, label, lines)
        yield axes, arrow, partial(_turn, arrow, middle, tips)


def _tell(text: Any, lines: list[str], i: int) -> None:
    text.set_text(lines[i])


def _turn(arrow: Any, middle: Array, tips: Array, i: int) -> None:
    arrow.set_positions(middle - tips[i], middle + tips[i])


def end_card(figure: Any, scene: DemoScene) -> list[Any]:
    """The artists of the card, in the middle of the picture, in the order they are drawn."""
    from matplotlib.patches import FancyBboxPatch

    lines, size = card(scene), _pixels(figure) * 1.2
    high, wide = figure.bbox.height, figure.bbox.width
    row, across = LINE * size / high, min(0.94, 62.0 * size / wide)
    rows = len(lines) + 1.9
    left, top = 0.5 - 0.5 * across, 0.5 + 0.5 * row * rows
    paper = FancyBboxPatch(
        (left, top - row * rows),
        across,
        row * rows,
        boxstyle="round,pad=0.02",
        transform=figure.transFigure,
        facecolor=PAPER,
        edgecolor="#9fb0be",
        alpha=0.96,
        animated=True,
        mutation_aspect=wide / high,
    )
    figure.add_artist(paper)
    artists: list[Any] = [paper]
    ends = left + across * np.cumsum((0.0, *SHARES))

    def write(text: str, column: int, y: float, **style: Any) -> None:
        at, side = (ends[column], "left") if column < 2 else (ends[column + 1], "right")
        where = {"ha": side, "va": "center", "size": "large", "animated": True, "parse_math": False}
        artists.append(figure.text(at, y, text, **(where | style)))

    for column, (name, unit) in enumerate(HEAD):
        write(name, column, top - 0.5 * row, weight="bold")
        write(unit, column, top - 1.25 * row, size="medium", color="#546a7d")
    for number, line in enumerate(lines):
        y = top - (2.4 + number) * row
        for column, cell in enumerate(line.cells):
            style = {"color": fractions(line.colour), "weight": "bold"} if column == 0 else {}
            write(_short(cell) if column == 0 else cell, column, y, **style)
    return artists


def _short(name: str, most: int = 22) -> str:
    return name if len(name) <= most else f"{name[: most - 1]}…"


def _pixels(figure: Any) -> float:
    """The size of the font, in pixels."""
    import matplotlib

    return float(matplotlib.rcParams["font.size"]) * float(figure.dpi) / 72.0
