"""The posterior of a diagnosis as a level of disturbance: parameters, standard errors, bounds."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import kstest, truncnorm
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.experiments.config.posterior import posterior_limits, write_posterior

from swamp_rl.boat import load_boat
from swamp_rl.effects import load_disturbances
from swamp_rl.errors import UserError
from swamp_rl.files import read_yaml, write_yaml
from swamp_rl.simulator import parameters
from swamp_rl.simulator.reference import size_of
from tests.support.command_line import Call, assert_complains
from tests.support.command_line import call as call
from tests.support.diagnosis_file import CURRENT, WEAK, diagnosis, estimate
from tests.support.from_scratch import written

pytestmark = pytest.mark.numerical

BOAT = load_boat("swamp")


def test_what_is_drawn_has_the_mean_and_the_standard_error_of_the_diagnosis(tmp_path: Path) -> None:
    write_posterior(diagnosis(tmp_path, CURRENT), tmp_path / "found.yaml")
    level = load_disturbances(tmp_path / "found.yaml", BOAT.thruster_names)
    record = parameters(BOAT, 20_000)
    level.apply(record, np.random.default_rng(0).random((20_000, level.draw_count)))
    for field, value, doubt in (("current_north", 0.2, 0.02), ("current_east", -0.1, 0.03)):
        assert record[field].mean() == pytest.approx(value, abs=4.0 * doubt / np.sqrt(20_000))
        assert record[field].std() == pytest.approx(doubt, rel=0.03)


def test_causes_stay_as_measured_and_a_level_among_them_is_fitted_to_the_boat(tmp_path: Path) -> None:
    written(tmp_path, "large")
    (tmp_path / "extended_boat.yaml").write_text("extends: large.yaml\nname: large-extended\n")
    write_posterior(diagnosis(tmp_path, CURRENT), tmp_path / "found.yaml", "standard")
    boat = load_boat(tmp_path / "large.yaml")
    found = load_disturbances(tmp_path / "found.yaml", boat.thruster_names, size_of(boat))
    plain = load_disturbances("standard", boat.thruster_names, size_of(boat))
    record = parameters(boat, 1000)
    found.apply(record, np.random.default_rng(0).random((1000, found.draw_count)))
    assert record["current_north"].mean() == pytest.approx(0.2, abs=0.01)
    own = read_yaml(tmp_path / "found.yaml")
    assert [entry["effect"] for entry in own["effects"]] == [
        "current",
        *(e.effect.name for e in plain.entries if e.effect.name != "current"),
    ]
    assert found.offsets == plain.offsets


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ({"components": {"north": 1.0}}, "must be {north: ..., east: ...}"),
        ({"components": {"north": 1.0, "east": 0.0}, "speed": 2.0}, "remove speed"),
    ],
)
def test_components_that_are_no_vector_are_refused(entry: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=message):
        load_disturbances([{"effect": "wind", **entry}], BOAT.thruster_names)


def test_a_cause_that_does_not_carry_over_is_left_out_with_its_correlations(tmp_path: Path) -> None:
    matrix = [[1.0, 0.9, 0.2], [0.9, 1.0, 0.3], [0.2, 0.3, 1.0]]
    failed = WEAK | {"carries_over": False}
    path = diagnosis(tmp_path, failed, CURRENT, correlation=matrix)
    level = write_posterior(path, tmp_path / "found.yaml")
    assert [entry["effect"] for entry in level["effects"]] == ["current"]
    assert level["correlated"] == {"numbers": ["0.north", "0.east"], "matrix": [[1.0, 0.3], [0.3, 1.0]]}
    with pytest.raises(UserError, match="names none that carries over to held-out runs"):
        write_posterior(diagnosis(tmp_path, failed), tmp_path / "other.yaml")


@pytest.mark.parametrize(
    ("verdict", "others", "line"),
    [
        (
            "unexplained",
            [],
            "verdict unexplained: these effects explain a part of the model error, the rest is left out",
        ),
        (
            "indistinguishable",
            [["thruster_gain bs", "wind by_run + linear_drag"]],
            "verdict indistinguishable: the cause may also be wind (another in each run) + linear_drag",
        ),
    ],
)
def test_the_level_of_a_diagnosis_in_doubt_says_so(
    tmp_path: Path, call: Call, verdict: str, others: list[list[str]], line: str
) -> None:
    path = diagnosis(tmp_path, WEAK)
    found = json.loads(path.read_text()) | {"verdict": verdict, "indistinguishable": others}
    path.write_text(json.dumps(found))
    assert line in call("disturbances", path, "--out", "found.yaml")[1]
    assert read_yaml(tmp_path / "found.yaml")["description"].endswith(line)


def test_a_level_is_a_yaml_file_as_only_such_is_found_again(tmp_path: Path, call: Call) -> None:
    for name in ("found", "found.txt"):
        assert_complains(
            call("disturbances", diagnosis(tmp_path, WEAK), "--out", name), "end the name in .yaml"
        )
    assert call("disturbances", diagnosis(tmp_path, WEAK), "--out", "Found.YAML")[0] == 0
    assert [path.name for path in tmp_path.glob("[Ff]ound*")] == ["Found.YAML"]


def test_the_folder_of_a_diagnosis_stands_for_its_file(tmp_path: Path, call: Call) -> None:
    path = diagnosis(tmp_path, WEAK)
    for given, out in ((path, "by_file.yaml"), (tmp_path, "by_folder.yaml")):
        assert call("disturbances", given, "--out", tmp_path / out)[0] == 0
    assert (tmp_path / "by_folder.yaml").read_text() == (tmp_path / "by_file.yaml").read_text()
    assert_complains(
        call("disturbances", tmp_path.parent, "--out", "none.yaml"), "diagnosis.json: No such file"
    )


def test_nothing_is_drawn_beyond_the_bounds_of_an_effect(tmp_path: Path) -> None:
    write_posterior(diagnosis(tmp_path, WEAK), tmp_path / "found.yaml")
    level = load_disturbances(tmp_path / "found.yaml", BOAT.thruster_names)
    record = parameters(BOAT, 2_000)
    level.apply(record, np.linspace(0.0, np.nextafter(1.0, 0.0), 2_000)[:, None])
    gains = record["thruster_gain"][:, BOAT.thruster_names.index("bs")]
    assert 0.0 <= gains.min() < 1e-9 and np.all(np.diff(gains) >= 0.0)
    assert 0.2 < gains.max() <= 0.02 + 5.0 * 0.05
    assert np.median(gains) == pytest.approx(truncnorm.median(-0.4, 5.0, 0.02, 0.05), abs=1e-4)


def test_a_parameter_at_a_bound_is_constant(tmp_path: Path) -> None:
    at_edge = estimate(0.0, 0.3) | {"at_bound": True, "limit": "at_most"}
    cause = {"effect": "thruster_gain", "thruster": "bs", "parameters": {"gain": at_edge}}
    level = write_posterior(diagnosis(tmp_path, cause), tmp_path / "found.yaml")
    assert level["effects"] == [{"effect": "thruster_gain", "thruster": "bs", "gain": 0.0}]


def test_a_parameter_that_the_runs_do_not_determine_is_constant(tmp_path: Path) -> None:
    numbers = {"astern": estimate(1.0, 1e21) | {"identifiable": False}, "port": estimate(1.8, 0.1)}
    cause = {"effect": "drag_asymmetry", "parameters": numbers}
    level = write_posterior(diagnosis(tmp_path, cause), tmp_path / "found.yaml")
    (entry,) = level["effects"]
    assert entry["astern"] == 1.0
    assert entry["port"]["normal"][:2] == [1.8, 0.1]
    assert "correlated" not in level


def test_numbers_that_were_fitted_together_are_drawn_together(tmp_path: Path) -> None:
    matrix = [[1.0, -0.9, 0.5], [-0.9, 1.0, -0.3], [0.5, -0.3, 1.0]]
    sure = {"effect": "thruster_gain", "thruster": "bs", "parameters": {"gain": estimate(0.8, 0.05)}}
    write_posterior(diagnosis(tmp_path, CURRENT, sure, correlation=matrix), tmp_path / "found.yaml", "severe")
    level = load_disturbances(tmp_path / "found.yaml", BOAT.thruster_names)
    record = parameters(BOAT, 20_000)
    uniforms = np.random.default_rng(0).random((20_000, level.draw_count))
    level.apply(record, uniforms)
    drawn = np.array(
        [
            record["current_north"],
            record["current_east"],
            record["thruster_gain"][:, BOAT.thruster_names.index("bs")],
        ]
    )
    np.testing.assert_allclose(np.corrcoef(drawn), matrix, atol=0.02)
    for values, value, doubt in zip(drawn, (0.2, -0.1, 0.8), (0.02, 0.03, 0.05), strict=True):
        assert kstest(values, truncnorm(-5.0, 5.0, value, doubt).cdf).pvalue > 0.01
    alone = parameters(BOAT, 1)
    level.apply(alone, uniforms[7:8])
    assert alone["current_east"][0] == record["current_east"][7]
    result = level.drawn(uniforms[7])[0]
    assert result["east"] == record["current_east"][7]


def test_a_number_that_is_certain_is_left_out_of_what_is_drawn_together(tmp_path: Path) -> None:
    half = CURRENT | {"parameters": CURRENT["parameters"] | {"north": estimate(0.2, 0.0, "m/s")}}
    causes = (half, WEAK)
    matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.4], [0.0, 0.4, 1.0]]
    level = write_posterior(diagnosis(tmp_path, *causes, correlation=matrix), tmp_path / "found.yaml")
    assert level["correlated"] == {"numbers": ["0.east", "1.gain"], "matrix": [[1.0, 0.4], [0.4, 1.0]]}


@pytest.mark.parametrize(
    ("correlated", "message"),
    [
        ({"numbers": ["0.north", "0.east"]}, "correlated: must be"),
        ({"numbers": ["0.north"], "matrix": [[1.0]]}, "two or more"),
        (
            {"numbers": ["0.north", "0.nroth"], "matrix": [[1, 0], [0, 1]]},
            "'0.nroth' is not a parameter with a normal distribution",
        ),
        (
            {"numbers": ["0.north", "3.east"], "matrix": [[1, 0], [0, 1]]},
            "'3.east' is not a parameter with a normal distribution",
        ),
        (
            {"numbers": ["0.north", f"{'9' * 5000}.east"], "matrix": [[1, 0], [0, 1]]},
            "'99.*99.east' is not a parameter with a normal distribution",
        ),
        ({"numbers": ["0.north", "0.east"], "matrix": [[1, 0]]}, "2 rows of 2 numbers"),
        ({"numbers": ["0.north", "0.east"], "matrix": [[1, 2], [2, 1]]}, "none of correlations"),
        ({"numbers": ["0.north", "0.east"], "matrix": [[1, 0.5], [0.4, 1]]}, "none of correlations"),
    ],
)
def test_correlations_that_make_no_sense_are_refused(
    correlated: dict[str, Any], message: str, tmp_path: Path
) -> None:
    level = write_posterior(diagnosis(tmp_path, CURRENT), tmp_path / "found.yaml")
    write_yaml(tmp_path / "found.yaml", level | {"correlated": correlated})
    with pytest.raises(UserError, match=message):
        load_disturbances(tmp_path / "found.yaml", BOAT.thruster_names)


def test_the_start_and_the_other_effects_of_a_level_stay(tmp_path: Path) -> None:
    write_posterior(diagnosis(tmp_path, CURRENT), tmp_path / "found.yaml", among="severe")
    found, severe = read_yaml(tmp_path / "found.yaml"), load_disturbances("severe", BOAT.thruster_names)
    effects = [entry["effect"] for entry in found["effects"]]
    assert effects == [entry.effect.name for entry in severe.entries]
    assert found["effects"][0]["north"] == {"normal": [0.2, 0.02, 0.1, pytest.approx(0.3)]}
    assert found["start"] == read_yaml(Path("configs/disturbances/severe.yaml"))["start"]
    boats = GatesVectorEnv(3, disturbances=tmp_path / "found.yaml")
    boats.reset(seed=1)
    assert len({boats.fleet.params["current_north"][i] for i in range(3)}) == 3


@pytest.mark.parametrize(
    ("thruster", "left"),
    [
        ("ss", ["bs", "ss"]),
        ("bs", ["bs"]),
        ("{choice: [bs, bp, ss]}", ["bs", {"choice": ["bp", "ss"]}]),
        ("{choice: [bp, ss]}", ["bs", {"choice": ["bp", "ss"]}]),
    ],
)
def test_an_effect_of_another_thruster_stays_beside_that_of_the_diagnosis(
    thruster: str, left: list[Any], tmp_path: Path
) -> None:
    (tmp_path / "level.yaml").write_text(
        f"effects: [{{effect: thruster_gain, thruster: {thruster}, gain: 0.5}}]"
    )
    level = write_posterior(diagnosis(tmp_path, WEAK), tmp_path / "found.yaml", str(tmp_path / "level.yaml"))
    assert [entry["thruster"] for entry in level["effects"]] == left
    load_disturbances(tmp_path / "found.yaml", BOAT.thruster_names)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("effects: [current]", r"level.yaml: effects\[0\]: must be a mapping with the key effect"),
        ("effects: 5", "level.yaml: effects must be a list"),
        ("nonsense: 5", "level.yaml: unknown key 'nonsense'"),
        ("effects: [{effect: thruster_gain, thruster: 5, gain: 1}]", "unknown thruster 5"),
        ("start: [1]", "start must be a mapping"),
        ("boat: {length: 1}", r"boat must be \{length"),
        ("effects: [{effect: thruster_gain, thruster: all, gain: 1}]", "of all thrusters includes bs"),
    ],
)
def test_a_level_that_cannot_be_read_is_refused_as_its_loader_does_and_nothing_written(
    text: str, message: str, tmp_path: Path
) -> None:
    (tmp_path / "level.yaml").write_text(text)
    with pytest.raises(UserError, match=message):
        write_posterior(diagnosis(tmp_path, WEAK), tmp_path / "found.yaml", str(tmp_path / "level.yaml"))
    assert not (tmp_path / "found.yaml").exists()


def test_a_file_that_is_no_diagnosis_and_one_without_causes_are_refused(tmp_path: Path) -> None:
    (tmp_path / "other.json").write_text('{"verdict": "cause"}')
    for path, result in (
        ("other.json", "causes"),
        ("none.json", "No such file or directory; name a diagnosis"),
    ):
        with pytest.raises(UserError, match=result):
            write_posterior(tmp_path / path, tmp_path / "found.yaml")
    with pytest.raises(UserError, match="names no cause"):
        write_posterior(diagnosis(tmp_path), tmp_path / "found.yaml")


@pytest.mark.parametrize(
    ("cause", "correlation", "message"),
    [
        (CURRENT | {"effect": "curent"}, None, "did you mean 'current'"),
        ({"effect": "current", "parameters": {"nroth": estimate(0.2, 0.1)}}, None, "did you mean 'north'"),
        (
            {"effect": "current", "parameters": {"north": estimate(np.nan, 0.1)}},
            None,
            "NaN is not a finite number",
        ),
        (
            {"effect": "current", "parameters": {"north": estimate(0.1, -0.1)}},
            None,
            "north: its error is negative",
        ),
        (CURRENT, [[1.0, 2.0], [2.0, 1.0]], "none of correlations"),
        ({"effect": "current", "parameters": {"north": estimate(1e308, 0.0, "m/s")}}, None, "north"),
        (WEAK | {"parameters": {"gain": estimate(1e308, 0.1)}}, None, "gain"),
    ],
)
def test_a_diagnosis_that_cannot_be_is_refused_in_one_line_and_nothing_written(
    cause: dict[str, Any], correlation: list[list[float]] | None, message: str, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match=message) as refused:
        write_posterior(diagnosis(tmp_path, cause, correlation=correlation), tmp_path / "found.yaml")
    assert "\n" not in str(refused.value) and not (tmp_path / "found.yaml").exists()


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ([0.0, 1.0], "normal must be"),
        ([0.0, 0.0, -1.0, 1.0], "normal must be"),
        ([9.0, 1.0, -1.0, 1.0], "3 deviations"),
        ([0.5, 1.0, -1.0, 2.0], "out of range"),
    ],
)
def test_a_normal_distribution_that_makes_no_sense_is_refused(numbers: list[float], message: str) -> None:
    entry = {"effect": "thruster_gain", "thruster": "bs", "gain": {"normal": numbers}}
    with pytest.raises(UserError, match=message):
        load_disturbances([entry], BOAT.thruster_names)


def test_a_missing_force_is_drawn_with_what_was_fitted_beside_it_not_with_what_it_replaces(
    tmp_path: Path,
) -> None:
    drag = {"effect": "linear_drag", "parameters": {"coefficient": estimate(1.8, 0.5, "N s/m")}}
    path = diagnosis(tmp_path, drag)
    curve = {"component": "surge", "covariate": "yaw_rate", "knots": [-0.4, 0.0, 0.4]}
    curve |= {"values": [-5.0, 0.0, -5.0], "standard_errors": [0.2, 0.1, 0.2]}
    force = {"curves": [curve | {"units": ["N"]}], "beside": [WEAK], "written": True}
    force |= {"held_out": {"gain": 99.0, "low": 9.0, "level": 0.95}}
    doubt = {"verdict": "unexplained", "extension": force}
    path.write_text(json.dumps(json.loads(path.read_text()) | doubt))
    write_posterior(path, tmp_path / "found.yaml")
    (line,) = posterior_limits(path)
    assert line.endswith("force_curve stands for what no effect explains, in the range of the runs")
    weak, missing = read_yaml(tmp_path / "found.yaml")["effects"]
    assert weak["effect"] == "thruster_gain"
    assert missing == {"effect": "force_curve", **curve}
    record = parameters(BOAT, 2)
    level = load_disturbances(tmp_path / "found.yaml", BOAT.thruster_names)
    level.apply(record, np.full((2, level.draw_count), 0.5))
    path.write_text(json.dumps(json.loads(path.read_text()) | {"extension": force | {"written": False}}))
    write_posterior(path, tmp_path / "other.yaml")
    assert [one["effect"] for one in read_yaml(tmp_path / "other.yaml")["effects"]] == ["linear_drag"]
