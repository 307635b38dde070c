"""What stands in a figure is text, whoever named it."""

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from swamp_rl.figure_style import sheet, spaced_axes


@pytest.mark.parametrize("name", ["$_$", "$x$ and $y^{$", "a_b^c", "\\frac", "$$"])
def test_a_name_that_is_no_formula_is_drawn_as_it_stands(name: str, tmp_path: Path) -> None:
    with sheet(tmp_path / "figure.png", 2.0, 1.5) as figure:
        axes = figure.subplots()
        axes.plot([0.0, 1.0], label=name)
        axes.set(title=name, xlabel=name)
        axes.legend()
    assert (tmp_path / "figure.png").read_bytes().startswith(b"\x89PNG")


def test_a_figure_is_drawn_once_and_all_of_it_has_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []
    draw = Figure.draw
    monkeypatch.setattr(
        Figure, "draw", lambda figure, renderer: (drawn.append(figure), draw(figure, renderer))
    )
    with sheet(tmp_path / "figure.png", 3.0, 2.0) as figure:
        axes = figure.subplots()
        axes.set(ylabel="a name\nof two lines")
    assert len(drawn) == 1
    box = axes.get_tightbbox()
    assert box.x0 >= 0.0 and box.y0 >= 0.0 and box.x1 <= figure.bbox.x1


@pytest.mark.parametrize(("legend", "most"), [(True, 0.9), (False, 0.4)])
def test_room_above_axes_is_for_a_legend(legend: bool, most: float) -> None:
    """In inches, of a figure 3 inches high."""
    figure = Figure(figsize=(9.0, 3.0))
    (axes, *_) = spaced_axes(figure, 1, 3, legend=legend)[0]
    room = 3.0 * (1.0 - axes.get_position().y1)
    assert most - 0.4 < room < most
