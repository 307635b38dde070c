"""What stands in a figure is text, whoever named it."""

from pathlib import Path

import pytest

from swamp_rl.figure_style import sheet


@pytest.mark.parametrize("name", ["$_$", "$x$ and $y^{$", "a_b^c", "\\frac", "$$"])
def test_a_name_that_is_no_formula_is_drawn_as_it_stands(name: str, tmp_path: Path) -> None:
    with sheet(tmp_path / "figure.png", 2.0, 1.5) as figure:
        axes = figure.subplots()
        axes.plot([0.0, 1.0], label=name)
        axes.set(title=name, xlabel=name)
        axes.legend()
    assert (tmp_path / "figure.png").read_bytes().startswith(b"\x89PNG")
