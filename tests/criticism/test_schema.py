"""The published schema of diagnosis.json, and the command's real output against it."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
import yaml
from swamp_rl.experiments.synthetic.cases import draw_case, write_case

from swamp_rl.boat import load_boat
from swamp_rl.criticism.diagnose import diagnose
from swamp_rl.criticism.result import TITLE, Diagnosis
from swamp_rl.json_text import schema_text

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("schema")]  # what they share is made once

PUBLISHED = Path(__file__).parents[2] / "docs" / "diagnosis.schema.json"


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a real diagnosis of three short straight runs."""
    folder = tmp_path_factory.mktemp("schema")
    rng = np.random.default_rng(5)
    write_case(draw_case(rng, "A", "confounded"), rng, folder / "data", folder / "truth.json", 3, 30.0)
    diagnose(folder / "data", "swamp", folder / "answer")
    return folder / "answer"


def test_the_published_schema_is_that_of_the_code() -> None:
    text = schema_text(Diagnosis, TITLE)
    assert PUBLISHED.read_text(encoding="utf-8") == text, (
        "write it anew: python -m swamp_rl.criticism.result docs/diagnosis.schema.json"
    )
    jsonschema.Draft202012Validator.check_schema(json.loads(text))


def test_a_real_diagnosis_fits_the_schema_and_one_with_a_wrong_verdict_does_not(answer: Path) -> None:
    schema = json.loads(PUBLISHED.read_text(encoding="utf-8"))
    found: dict[str, Any] = json.loads((answer / "diagnosis.json").read_text(encoding="utf-8"))
    jsonschema.validate(found, schema)
    assert Diagnosis.model_validate(found).verdict == found["verdict"]
    numbers = sum(len(cause["parameters"]) for cause in (*found["causes"], *found["nuisance"]))
    assert np.shape(found["correlation"]) == ((numbers, numbers) if numbers else (0,))
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(found | {"verdict": "guilty"}, schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({name: value for name, value in found.items() if name != "gain"}, schema)


def test_beside_it_lie_a_boat_that_loads_and_a_page_that_needs_nothing_else(answer: Path) -> None:
    boat = load_boat(answer / "extended_boat.yaml")
    assert yaml.safe_load((answer / "extended_boat.yaml").read_text())["extends"] == "swamp"
    found = json.loads((answer / "diagnosis.json").read_text())
    assert {entry.effect.name for entry in boat.effects} == {one["effect"] for one in found["causes"]}
    page = (answer / "report.html").read_text(encoding="utf-8")
    assert 'src="http' not in page and 'href="http' not in page
    assert page.count("data:image/png;base64,") >= 3
