"""The verbs that list what there is: all of it once, with units and bounds; the nearest of a wrong name."""

from pathlib import Path

import pytest
import yaml

from swamp_rl.boat import load_boat
from swamp_rl.effects import LIBRARY
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call  # the fixture

CONFIGS = Path(__file__).parents[3] / "configs"


def lines(call: Call, *words: str) -> list[str]:
    code, out, error = call(*words)
    assert (code, error) == (0, "")
    return out.splitlines()


def test_every_effect_is_listed_once_with_all_its_parameters_units_and_source(call: Call) -> None:
    listed = "\n".join(lines(call, "effects"))
    for effect in LIBRARY.values():
        (block,) = (part for part in listed.split("\n") if part.startswith(f"{effect.name}: "))
        assert effect.description in block
        assert f"source: {effect.source}" in listed
        one = lines(call, "effects", effect.name)
        entries = (
            "  thruster:",
            "  component, ",
            "  formula: ",
            "  the same in every run",
            "  may differ",
            "  never a cause",
        )
        rows = [line for line in one[2:] if not line.startswith(entries)]
        assert len(rows) == len(effect.parameters)
        for line, parameter in zip(rows, effect.parameters, strict=True):
            assert line.startswith(f"  {parameter.name}: ") and f"[{parameter.unit}]" in line
        assert any(line.startswith("  thruster:") for line in one) == (effect.selects or effect.curve)


def test_an_effects_bounds_neutral_value_and_whether_it_must_be_given_are_reported(call: Call) -> None:
    (speed,) = (line for line in lines(call, "effects", "wind") if line.startswith("  speed"))
    assert speed == "  speed: at least 0 and at most 200 [m/s]; neutral: 0; must be given"
    assert "  mass: above 0 [kg]; neutral: the boat file's" in lines(call, "effects", "mass")


@pytest.mark.parametrize("kind", ["boats", "courses"])
def test_every_shipped_file_is_listed(call: Call, kind: str) -> None:
    listed = [line.split()[0].rstrip(":") for line in lines(call, kind) if not line.startswith(" ")]
    assert listed == sorted(path.stem for path in (CONFIGS / kind).glob("*.yaml"))


def test_a_boat_is_reported_number_by_number(call: Call) -> None:
    shown = lines(call, "boats", "swamp")
    assert len(shown) == len(load_boat("swamp").provenance)
    assert "mass = 58 [kg], measured: thesis 4.4.1 and 8.1.3, full load" in shown
    assert "thrusters.ss.x = -0.35 [m], measured: thesis 5.7.1" in shown
    assert any(line.startswith("resistance.table.0.speed = 0.5, 0.62, 0.74, 0.88, 1 [m/s]") for line in shown)


def test_a_boat_file_by_its_path_tells_its_effects(call: Call, tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("extends: swamp\neffects: [{effect: current, north: 0.1}]\n")
    assert lines(call, "boats", "mine.yaml")[-1] == "effect current: north 0.1 m/s, east 0 m/s"


def test_a_course_is_reported_in_degrees_and_metres(call: Call) -> None:
    shown = lines(call, "courses", "camogli")
    assert shown[0] == "camogli: 2 gates, time limit 120 s"
    assert "  gate red: north 22, east 8 m, width 4 m, passed towards 0 deg" in shown


def test_a_scaled_course_is_reported_to_a_centimetre_and_a_tenth(call: Call, tmp_path: Path) -> None:
    (tmp_path / "pond.yaml").write_text(
        "extends: camogli\nscale: 0.7\nstart:\n  pose: {north: 0.0, east: 0.123456, heading: 0.8}\n"
        "  spread: {north: 1.0, east: 1.0, heading: 0.1}\n"
    )
    shown = lines(call, "courses", "pond.yaml")
    assert shown[0] == "pond: 2 gates, time limit 100.4 s"
    assert "  start: north 0, east 0.12 m, 45.8 deg" in shown


def test_every_kind_of_pilot_tells_its_options_with_default_and_bounds(call: Call) -> None:
    kinds = [line.split()[0] for line in lines(call, "pilots")]
    assert {"scripted", "reservoir", "cloning", "ppo", "sb3", "onnx"} <= set(kinds)
    for kind in kinds:
        assert lines(call, "pilots", kind)
    (decisions,) = (line for line in lines(call, "pilots", "ppo") if line.startswith("decisions"))
    assert decisions == "decisions (default 1200000; at least 1, at most 1000000000)"
    (fitted,) = (line for line in lines(call, "pilots", "dagger") if line.startswith("learner"))
    default = yaml.safe_load(fitted.partition("(default ")[2].partition("})")[0] + "}")
    assert default["senses"][0] == "north" and default["forgetting"] is None


@pytest.mark.parametrize(
    ("words", "near"),
    [
        (["effects", "curent"], "did you mean 'current'?"),
        (["boats", "swamp-lite"], "did you mean 'swamp-light'?"),
        (["courses", "camoglie"], "did you mean 'camogli'?"),
        (["pilots", "ppo2"], "did you mean 'ppo'?"),
        (["boats", "nowhere.yaml"], "no such file"),
    ],
)
def test_a_name_that_there_is_not_is_one_line_with_the_nearest(
    call: Call, words: list[str], near: str
) -> None:
    assert_complains(call(*words), near)
