"""The public names: found, light to import, known to type checkers, and right where they add something."""

import ast
import math
import pydoc
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swamp_rl.experiments.config.load import load_experiment

import swamp_rl
from swamp_rl.errors import UserError
from swamp_rl.manoeuvres.captive import resistance_at
from swamp_rl.runs import Run, append_run, create_dataset
from tests.support.identification import folder_of
from tests.support.runs import circling, described

ROOT = Path(__file__).parents[1]
BOAT = swamp_rl.load_boat("swamp-thesis")
K = len(BOAT.thrusters)


def straight_ahead(rows: int, throttle: float) -> np.ndarray:
    return np.hstack([np.zeros((rows, K)), np.full((rows, K), throttle)])


def test_every_public_name_is_documented_and_known_to_type_checkers() -> None:
    assert all(getattr(swamp_rl, name).__doc__ for name in swamp_rl.PUBLIC)
    stub = ast.parse((ROOT / "swamp_rl" / "__init__.pyi").read_text())
    entries = {
        alias.asname: f"{node.module}:{alias.name}"
        for node in stub.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    packages = {"swamp_rl:course": "swamp_rl.course", "swamp_rl:effects": "swamp_rl.effects"}
    assert {name: packages.get(place, place) for name, place in entries.items()} == swamp_rl.PUBLIC
    assert set(swamp_rl.PUBLIC) <= set(dir(swamp_rl))


def test_help_documents_the_public_functions() -> None:
    text = pydoc.render_doc(swamp_rl, renderer=pydoc.plaintext)
    functions = [name for name, place in swamp_rl.PUBLIC.items() if ":" in place]
    assert [name for name in functions if not re.search(rf"^    {name}(\(| = )", text, re.MULTILINE)] == []


def test_a_dataset_that_was_read_is_taken_wherever_its_folder_is(folder: Path, tmp_path: Path) -> None:
    dataset = swamp_rl.read_runs(folder)
    for task in (swamp_rl.diagnose, swamp_rl.identify_boat):
        with pytest.raises(UserError, match=rf"{folder}: .*too short"):
            task(dataset, "swamp", tmp_path / "out.yaml")
        with pytest.raises(UserError, match=f"{folder}: its runs are read again from the folder"):
            task(replace(dataset, runs=dataset.runs[:1]), "swamp", tmp_path / "out.yaml")
    with pytest.raises(UserError, match=rf"{folder}: .*too short"):
        swamp_rl.diagnose([dataset], None, tmp_path / "out")


def test_a_boat_that_was_read_is_taken_or_its_file_is_asked_for(folder: Path, tmp_path: Path) -> None:
    ((named, _),) = swamp_rl.trial("straight", "swamp-thesis", throttle=0.5)
    ((read, _),) = swamp_rl.trial("straight", BOAT, throttle=0.5)
    assert np.array_equal(named.pose, read.pose)
    with pytest.raises(UserError, match="; record "):
        swamp_rl.identify(folder, "elementary", BOAT)
    asked = "one of the boats is of the type Boat; give a name or a path"
    for task in (
        lambda: swamp_rl.read_runs(folder, boat=BOAT),
        lambda: swamp_rl.diagnose(folder, BOAT, tmp_path / "out"),
        lambda: swamp_rl.identify_boat(folder, BOAT, tmp_path / "out.yaml"),
    ):
        with pytest.raises(UserError, match=asked):
            task()


def test_a_text_alone_is_one_override_or_one_pilot() -> None:
    assert load_experiment("smoke", "evaluation.episodes=3").evaluation.episodes == 3
    with pytest.raises(UserError, match="no pilot 'reservoir-alne'; did you mean 'reservoir-alone'"):
        swamp_rl.train("smoke", only="reservoir-alne")


def test_a_name_that_there_is_not_is_refused_as_python_does() -> None:
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        swamp_rl.simulat  # noqa: B018


def test_the_steady_speed_is_where_thrust_and_resistance_are_equal() -> None:
    run = swamp_rl.simulate(BOAT, straight_ahead(1200, 0.7))
    thrust = 4 * 12.2 * 0.7**2 * (0.30 + (0.7 - 0.3) / 0.7 * 0.45)  # thesis table 5.5 and 7.3.5
    assert resistance_at(BOAT, run.columns["surge"][-1]) == pytest.approx(thrust, rel=0.01)
    assert run.columns["north"].shape == (1200,)
    assert run.columns["east"] == pytest.approx(0.0, abs=1e-9)


def test_a_run_replayed_is_the_run() -> None:
    commands = straight_ahead(100, 0.5)
    commands[40:, : K // 2] = 0.3
    run = swamp_rl.simulate(BOAT, commands)
    again = swamp_rl.simulate("swamp-thesis", run)
    for name in ("north", "east", "surge", "yaw_rate"):
        assert again.columns[name] == pytest.approx(run.columns[name], abs=1e-6)


@pytest.mark.parametrize(
    ("commands", "step", "part"),
    [
        (np.zeros((5, 3)), 0.1, "must be (T, 8)"),
        (np.zeros((1, 8)), 0.1, "T at least 2"),
        (np.full((5, 8), np.nan), 0.1, "row 0, column 0"),
        (
            straight_ahead(5, 60.0),
            0.1,
            "row 0, column throttle_bs: 60 is outside [0, 1]; it looks like percent",
        ),
        (np.full((5, 8), 0.5) * [[30.0] * K + [1.0] * K], 0.1, "row 0, column azimuth_bs: 15 is outside"),
        ("full ahead", 0.1, "not an array of numbers"),
        (np.zeros((5, 8)), 0.0, "step must be above 0"),
        (np.zeros((5, 8)), math.nan, "step must be above 0"),
        (np.zeros((5, 8)), "0.1", "step must be above 0"),
    ],
)
def test_commands_of_another_boat_are_refused(commands: object, step: Any, part: str) -> None:
    with pytest.raises(UserError, match=re.escape(part)):
        swamp_rl.simulate(BOAT, commands, step)


@pytest.mark.parametrize("seed", [-1, 1.5, "one", True])
def test_a_seed_that_is_none_is_refused(seed: Any) -> None:
    for commands in (straight_ahead(5, 0.5), swamp_rl.simulate(BOAT, straight_ahead(5, 0.5))):
        with pytest.raises(UserError, match="simulate: seed must be a whole number of at least 0, not"):
            swamp_rl.simulate(BOAT, commands, seed=seed)


def test_a_runs_commands_in_percent_are_refused_and_azimuths_that_count_turns_are_not() -> None:
    run = swamp_rl.simulate(BOAT, straight_ahead(20, 0.5))
    percent = {
        name: 100 * values if name.startswith("throttle") else values for name, values in run.columns.items()
    }
    with pytest.raises(UserError, match=r"row 1, column throttle_bs: 50 is outside .*percent"):
        swamp_rl.simulate(BOAT, Run("log", percent))
    turning = straight_ahead(200, 0.5)
    turning[:, :K] = np.linspace(0.0, 20.0, 200)[:, None]
    assert swamp_rl.simulate("swamp", turning).columns["azimuth_bs"][-1] == 20.0


def test_azimuths_in_degrees_that_turn_a_little_in_each_step_are_refused() -> None:
    swinging = straight_ahead(200, 0.5)
    swinging[:, :K] = np.degrees(0.6 * np.sin(0.1 * np.arange(200)))[:, None]
    with pytest.raises(UserError, match=r"row 2, column azimuth_bs: .*degrees"):
        swamp_rl.simulate("swamp", swinging)
    swinging[:, :K] = np.radians(swinging[:, :K])
    swamp_rl.simulate("swamp", swinging)


def test_circles_to_either_side_are_mirror_images() -> None:
    done = swamp_rl.trial("turning-circle", "swamp", throttle=[0.6], angle_deg=[30, -30], turns=2)
    starboard, port = (result.figures["steady_diameter"].value for _, result in done)
    assert starboard == pytest.approx(port, rel=1e-3)
    (first, _), (second, _) = done
    assert first.name != second.name


def test_a_wrong_key_of_a_trial_is_one_line() -> None:
    with pytest.raises(UserError, match="did you mean 'throttle'"):
        swamp_rl.trial("turning-circle", throtle=[0.6], angle_deg=[30])


@pytest.mark.parametrize(("folders", "part"), [("nowhere", "nowhere: no such folder"), ([], "no folder")])
def test_there_must_be_folders_to_evaluate(folders: object, part: str) -> None:
    with pytest.raises(UserError, match=part):
        swamp_rl.evaluate(folders)


def test_an_object_in_place_of_a_name_or_a_folder_is_one_line() -> None:
    with pytest.raises(UserError, match=r"type Boat was given; .* save the model and name its file: sb3:"):
        swamp_rl.evaluate(BOAT)
    for task in (swamp_rl.train, swamp_rl.run_experiment):
        with pytest.raises(UserError, match="one of the experiments is of the type dict; give a name or a"):
            task({"name": "mine"})
    for folders in (3, None, b"runs", ["runs"]):
        for task in (swamp_rl.read_runs, swamp_rl.identify):
            with pytest.raises(UserError, match="one of the datasets is of the type"):
                task(folders)


def test_what_is_written_must_have_a_path(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    create_dataset(runs, described())
    append_run(runs, Run("run", circling(30.0)), "csv")
    tasks: list[Callable[[Any], object]] = [
        lambda out: swamp_rl.evaluate("line-of-sight", {"episodes": 1}, out=out),
        lambda out: swamp_rl.train("smoke", out=out),
        lambda out: swamp_rl.run_experiment("smoke", out=out),
        lambda out: swamp_rl.diagnose(runs, "swamp", out),
        lambda out: swamp_rl.identify_boat(runs, "swamp", out),
    ]
    for task in tasks:
        for out in (3, b"out", ["out"]):
            with pytest.raises(UserError, match=f"out: is of the type {type(out).__name__}; give the path"):
                task(out)


def test_identified_thrust_deduction_is_the_boat_files(tmp_path: Path) -> None:
    runs = [
        Run(name, swamp_rl.simulate(BOAT, straight_ahead(900, throttle)).columns)
        for name, throttle in (("slow", 0.4), ("fast", 1.0))
    ]
    found = swamp_rl.identify(folder_of(tmp_path / "straight", BOAT, runs), "thrust-deduction")
    assert [one.value for one in found] == pytest.approx([0.3 + 0.1 / 0.7 * 0.45, 0.75], abs=0.01)
    assert all(one.low <= one.value <= one.high and one.unit == "1" for one in found)


def test_what_no_run_can_identify_says_what_to_record(folder: Path) -> None:
    """The folder's runs are 3 s of a circle."""
    for model in ("elementary", "thrust-deduction"):
        with pytest.raises(UserError, match="; record "):
            swamp_rl.identify(folder, model)
    with pytest.raises(UserError, match="did you mean 'yaw-model'"):
        swamp_rl.identify(folder, "yaw_model")
