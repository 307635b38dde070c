"""How every chart of the project looks, and a sheet to draw one on without a screen."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

STYLE: Any = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e6e9ec",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "axes.titlesize": 10,
    "figure.dpi": 130,
    "text.parse_math": False,  # names of runs and pilots are no formulas, and a wrong one cannot be drawn
}


@contextmanager
def styled(style: Any = STYLE) -> Iterator[None]:
    """Within the block charts have matplotlib's own defaults and this style, whatever `matplotlibrc` says.

    matplotlib reads one in the working directory too, which may be that of a stranger's dataset.
    """
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(style)
        yield


@contextmanager
def sheet(path: Path, width: float, height: float, fitted: bool = True) -> Iterator[Any]:
    """A new figure [inches], saved as PNG at the end of the block; imports matplotlib only here.

    fitted: the margins are fitted to the labels, which takes as long as drawing the figure twice; those of
    `spaced_axes` are not.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    with styled():
        layout = ConstrainedLayoutEngine(h_pad=0.06, w_pad=0.06) if fitted else None
        figure = Figure(figsize=(width, height), layout=layout)
        FigureCanvasAgg(figure)
        yield figure
        save(figure, path)


def spaced_axes(
    figure: Any, rows: int, columns: int, labelled: bool = True, legend: bool = True, **shared: Any
) -> Any:
    """Axes (rows, columns) with room for labels, and for a `legend` above; labelled: each has tick labels of
    its own.
    """
    width, height = figure.get_size_inches()
    left, right, bottom = 0.92, 0.14, 0.5  # inches
    between, above, top = (0.98, 0.75, 0.62) if labelled else (0.14, 0.16, 0.36)
    top = top if legend else 0.12
    figure.subplots_adjust(
        left=left / width,
        right=1.0 - right / width,
        bottom=bottom / height,
        top=1.0 - top / height,
        wspace=between * columns / (width - left - right - (columns - 1) * between),
        hspace=above * rows / (height - bottom - top - (rows - 1) * above),
    )
    return figure.subplots(rows, columns, squeeze=False, **shared)


def save(figure: Any, path: Path, **options: Any) -> None:
    """Write a figure; with a layout engine `savefig` alone would draw it twice, once for the layout."""
    if figure.get_layout_engine():
        figure.get_layout_engine().execute(figure)
        figure.set_layout_engine(None)
    figure.savefig(path, **options)
