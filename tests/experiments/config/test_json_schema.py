"""The published schema of experiment files agrees with the command; a typo names the nearest key."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from swamp_rl.experiments.config.json_schema import schema_text
from swamp_rl.experiments.config.learners import LEARNERS, learner
from swamp_rl.experiments.config.load import load_experiment

from swamp_rl.errors import UserError

ROOT = Path(__file__).parents[3]
PUBLISHED = ROOT / "docs" / "experiment.schema.json"
SHIPPED = sorted((ROOT / "configs" / "experiments").glob("*.yaml"))
SOUND = {
    "name": "sound",
    "boat": "swamp",
    "course": "camogli",
    "pilots": {
        "net": {"kind": "cloning", "runs": 2, "options": {"epochs": 3}},
        "people": {"kind": "scripted"},
    },
    "evaluation": {"levels": ["calm"], "episodes": 5, "seed": 1},
}
Path_ = tuple[str, ...]


def fits(data: Any) -> bool:
    return jsonschema.Draft202012Validator(json.loads(schema_text())).is_valid(data)


def changed(data: Any, path: Path_, value: Any) -> dict[str, Any]:
    """A copy with the value put at a path of keys, or the key dropped where the value is None."""
    copy = json.loads(json.dumps(data))
    *above, last = path
    inner = copy
    for key in above:
        inner = inner.setdefault(key, {})
    inner.pop(last, None)
    if value is not None:
        inner[last] = value
    return copy


def refused(folder: Path, data: Any) -> str:
    """What the command says of the file."""
    (folder / "it.yaml").write_text(yaml.safe_dump(data))
    with pytest.raises(UserError) as error:
        load_experiment(folder / "it.yaml")
    assert all(line.startswith(f"{folder / 'it.yaml'}: ") for line in str(error.value).split("\n"))
    return str(error.value)


def test_the_published_schema_is_that_of_the_code() -> None:
    assert PUBLISHED.read_text(encoding="utf-8") == schema_text(), (
        "write it anew: python -m swamp_rl.experiments.config.json_schema docs/experiment.schema.json"
    )
    jsonschema.Draft202012Validator.check_schema(json.loads(schema_text()))


@pytest.mark.parametrize("file", SHIPPED, ids=lambda file: file.stem)
def test_a_shipped_experiment_fits_the_schema_that_its_first_line_names(file: Path) -> None:
    first = file.read_text().splitlines()[0]
    assert first.startswith("# yaml-language-server: $schema=")
    assert (file.parent / first.partition("=")[2]).resolve() == PUBLISHED
    assert fits(yaml.safe_load(file.read_text()))


@pytest.mark.parametrize("file", SHIPPED, ids=lambda file: file.stem)
def test_an_experiment_with_every_option_written_out_fits_too(file: Path) -> None:
    assert fits(load_experiment(file).model_dump(mode="json"))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("boat",), None),
        (("evaluation", "episodes"), None),
        (("evaluation", "episodes"), 0),
        (("evaluation", "episdes"), 5),
        (("step",), "fast"),
        (("pilots", "net", "kind"), None),
        (("pilots", "net", "kind"), "clonning"),
        (("pilots", "net", "disturbances"), "calm"),
        (("pilots", "net", "options", "decisions"), 5),
        (("pilots", "net", "options", "epochs"), 0.5),
        (("pilots", "people", "runs"), 2),
        (("pilots", "people", "takeover"), 2.0),
        (("targets", "sucess"), {}),
        (("data", "record", "god"), 3),
    ],
)
def test_what_the_command_refuses_the_schema_refuses_as_well(tmp_path: Path, path: Path_, value: Any) -> None:
    assert fits(SOUND)
    wrong = changed(SOUND, path, value)
    assert not fits(wrong)
    assert refused(tmp_path, wrong)


def test_a_pilot_of_ones_own_fits_with_whatever_options_it_has() -> None:
    assert fits(changed(SOUND, ("pilots", "net"), {"kind": "mine.pilot:Mine", "options": {"any": 1}}))
    assert fits(changed(SOUND, ("pilots", "net"), {"kind": "sb3", "options": {"file": "model.zip"}}))


def test_a_file_that_extends_another_may_leave_out_what_that_one_has() -> None:
    assert fits({"extends": "camogli", "pilots": {"ppo": {"options": {"decisions": 5}}}})
    assert fits({"extends": "camogli", "evaluation": {"episodes": 5}})
    assert not fits({"extends": "camogli", "pilots": {"ppo": {"options": {"decisons": 5}}}})
    assert not fits({"extends": "camogli", "evaluation": {"episdes": 5}})


def test_every_kind_of_pilot_has_its_options_in_the_schema() -> None:
    parts = json.loads(PUBLISHED.read_text())["$defs"]
    for kind in LEARNERS:
        assert set(parts[f"{kind} options"]["properties"]) == set(learner(kind).settings.model_fields)


def keys(data: Any, above: Path_ = ()) -> Iterator[Path_]:
    """The path of every key of four letters or more that is not a name given by the file itself."""
    if isinstance(data, dict):
        for key, value in data.items():
            if len(key) >= 4 and above[-1:] != ("pilots",):
                yield (*above, key)
            yield from keys(value, (*above, key))


def test_a_letter_left_out_of_any_key_is_reported_with_the_key_that_was_meant(tmp_path: Path) -> None:
    whole = load_experiment(ROOT / "configs" / "experiments" / "smoke.yaml").model_dump(mode="json")
    whole = {**whole, "targets": {"success": {}, "smoother_than_data": []}}
    tried = list(keys(whole))
    assert len(tried) > 60
    for path in tried:
        value: Any = whole
        for key in path:
            value = value[key]
        typo = path[-1][:2] + path[-1][3:]
        renamed = changed(changed(whole, path, None), (*path[:-1], typo), "" if value is None else value)
        assert f"did you mean {path[-1]!r}?" in refused(tmp_path, renamed), path


def test_a_typo_in_an_override_and_in_extends_is_reported_likewise(tmp_path: Path) -> None:
    for override, meant in (("evaluatoin.seed=1", "evaluation"), ("pilots.ppo.options.hodl=2", "hold")):
        with pytest.raises(UserError, match=f"did you mean '{meant}'"):
            load_experiment("smoke", [override])
    assert "did you mean 'extends'" in refused(tmp_path, {"extend": "camogli"})
