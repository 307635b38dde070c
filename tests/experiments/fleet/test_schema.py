"""The published schema of fleet.json is in step with the models."""

from pathlib import Path

from swamp_rl.experiments.fleet.result import TITLE, Fleet

from swamp_rl.json_text import schema_text

PUBLISHED = Path(__file__).parents[3] / "docs" / "fleet.schema.json"


def test_the_published_schema_is_that_of_the_models() -> None:
    assert PUBLISHED.read_text(encoding="utf-8") == schema_text(Fleet, TITLE), (
        "python -m swamp_rl.experiments.fleet.result docs/fleet.schema.json"
    )
