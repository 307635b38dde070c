"""Joint errors of an identified boat's numbers, in its file."""

from pathlib import Path

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat.digest import boat_digest
from swamp_rl.boat.mapping import boat_mapping
from swamp_rl.errors import UserError
from swamp_rl.files import write_yaml

GIVEN = """
covariance:
  source: day 1
  numbers: [mass, inertia_z, hull.y_v]
  standard_errors: [0.1, 0.2, 0.03]
  correlation: [[], [0.9], [-0.5, 0.25]]
"""


def boat_file(folder: Path, text: str) -> Path:
    path = folder / "mine.yaml"
    path.write_text("extends: swamp\n" + text)
    return path


def test_the_errors_of_a_boat_file_are_kept_by_a_file_written_from_it(tmp_path: Path) -> None:
    boat = load_boat(boat_file(tmp_path, GIVEN))
    write_yaml(tmp_path / "again.yaml", boat_mapping(boat))
    again = load_boat(tmp_path / "again.yaml").covariance
    assert again is not None and again == boat.covariance
    assert np.allclose(again.matrix, again.matrix.T)
    assert again.matrix[2, :] == pytest.approx([-0.5 * 0.003, 0.25 * 0.006, 0.0009])


def test_errors_change_no_digest(tmp_path: Path) -> None:
    assert boat_digest(load_boat(boat_file(tmp_path, GIVEN))) == boat_digest(load_boat("swamp"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[0.9]", "[1.5]", "covariance.correlation.1.0: must be at most 1"),
        ("[], [0.9]", "[0.9]", "correlation: must be 3 rows of 0, 1, 2 and so on numbers"),
        ("0.2, 0.03", "0.2", "standard_errors: must be 3, one of each number"),
        ("inertia_z", "mass", "numbers: must differ"),
        ("0.1", "-0.1", "covariance.standard_errors.0: must be at least 0"),
        ("0.1", "1.0e+200", "covariance.standard_errors.0: must be at most 1e+20"),
    ],
)
def test_errors_that_are_no_triangle_of_correlations_are_refused(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    with pytest.raises(UserError) as error:
        load_boat(boat_file(tmp_path, GIVEN.replace(old, new)))
    assert message in str(error.value) and len(str(error.value).splitlines()) == 1
