"""Experiment files: extended, overridden, and refused in one clear line."""

from pathlib import Path

import pytest
from swamp_rl.experiments.artifacts.provenance import with_data_hash
from swamp_rl.experiments.config.layers import merged
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import config_files, read_scene

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError
from swamp_rl.files import find_config

SMALL = """
name: small
boat: swamp
course: camogli
pilots:
  scripted: {kind: scripted}
  net: {kind: cloning, options: {epochs: 3}}
evaluation: {levels: [calm], episodes: 5, seed: 1}
"""


TARGETS = "targets: {success: {net: {calm: 0.5, severe: 0.1}}, smoother_than_data: [net]}"


def write(folder: Path, text: str, name: str = "small.yaml") -> Path:
    (folder / name).write_text(text)
    return folder / name


def complaint(path: Path, *overrides: str) -> str:
    with pytest.raises(UserError) as error:
        load_experiment(path, overrides)
    assert all(line.strip() for line in str(error.value).split("\n"))
    return str(error.value)


@pytest.mark.parametrize("name", ["camogli", "smoke"])
def test_the_experiments_that_are_shipped_are_sound(name: str) -> None:
    assert load_experiment(name).name == name


def test_the_main_job_asks_for_what_was_set_as_its_target() -> None:
    experiment = load_experiment("camogli")
    assert experiment.evaluation.episodes == 1000
    assert experiment.evaluation.levels == ("calm", "standard", "severe")
    assert experiment.pilots["reservoir"].runs == 20
    assert experiment.targets.success == {
        "reservoir": {"calm": 0.99, "standard": 0.90},
        "cloning": {"calm": 0.99, "standard": 0.90},
        "ppo": {"calm": 0.99, "standard": 0.97},
    }


def test_options_not_given_are_written_out_with_their_defaults(tmp_path: Path) -> None:
    options = load_experiment(write(tmp_path, SMALL)).pilots["net"].options
    assert options["epochs"] == 3
    assert {"senses", "hidden", "learning_rate", "seed"} <= options.keys()


def test_overrides_reach_any_depth_and_keep_what_they_do_not_name(tmp_path: Path) -> None:
    path = write(tmp_path, SMALL)
    experiment = load_experiment(path, ["evaluation.episodes=9", "pilots.net.options.hidden=[8, 8]"])
    assert (experiment.evaluation.episodes, experiment.evaluation.seed) == (9, 1)
    assert experiment.pilots["net"].options["hidden"] == [8, 8]
    assert experiment.pilots["net"].options["epochs"] == 3


def test_an_extending_file_overrides_key_by_key(tmp_path: Path) -> None:
    write(tmp_path, SMALL)
    path = write(tmp_path, "extends: small.yaml\nname: smaller\nevaluation: {episodes: 2}", "smaller.yaml")
    experiment = load_experiment(path)
    assert (experiment.name, experiment.boat) == ("smaller", "swamp")
    assert (experiment.evaluation.episodes, experiment.evaluation.levels) == (2, ("calm",))


def test_a_path_that_exists_only_beside_the_file_is_taken_from_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "Läufe vom Hafen").mkdir()
    (tmp_path / "boats").mkdir()
    (tmp_path / "boats" / "mine.yaml").write_text("extends: swamp\n")
    (tmp_path / "swamp").mkdir()  # a bare name is never a folder beside the file
    mine = {"data: ": "{folder: Läufe vom Hafen}", "boat: ": "boats/mine.yaml"}
    text = SMALL.replace("boat: swamp\n", "") + "".join(f"{key}{value}\n" for key, value in mine.items())
    away = tmp_path / "away"
    away.mkdir()
    monkeypatch.chdir(away)
    experiment = load_experiment(write(tmp_path, text))
    assert Path(experiment.boat) == tmp_path / "boats" / "mine.yaml"
    assert Path(str(experiment.data.folder)) == tmp_path / "Läufe vom Hafen"
    assert load_experiment(write(tmp_path, SMALL)).boat == "swamp"
    (away / "boats").mkdir()
    (away / "boats" / "mine.yaml").write_text("extends: swamp-light\n")
    assert load_experiment(write(tmp_path, text)).boat == "boats/mine.yaml"  # the working directory first


def test_the_level_of_the_logs_of_a_closed_loop_is_found_beside_the_file_and_kept(tmp_path: Path) -> None:
    (tmp_path / "squall.yaml").write_text("effects: [{effect: wind, speed: 3.0, from: 0.0}]\n")
    hidden = (
        "hidden: {effects: [{effect: mass, mass: 60.0}], logs: {disturbances: squall.yaml}}\n"
        "pilots: {net: {kind: cloning}}\n"
    )
    text = SMALL.replace("  scripted: {kind: scripted}\n  net: {kind: cloning, options: {epochs: 3}}\n", "")
    scene = read_scene(load_experiment(write(tmp_path, text.replace("pilots:\n", hidden))))
    assert config_files(scene)["disturbances/squall.yaml"] == tmp_path / "squall.yaml"


@pytest.mark.parametrize(
    ("runs", "skill", "refused"), [(20, "null", False), (21, "null", True), (11, "expert", True)]
)
def test_more_runs_than_are_recorded_are_refused_of_whichever_pilot(
    tmp_path: Path, runs: int, skill: str, refused: bool
) -> None:
    asked = [
        "data={record: {good: 10, skills: [novice, expert]}}",
        f"pilots.late={{kind: cloning, runs: {runs}, skill: {skill}}}",
    ]
    path = write(tmp_path, SMALL)
    if refused:
        assert f"pilots.late.runs: {runs} runs" in complaint(path, *asked)
    else:
        assert load_experiment(path, asked).pilots["late"].runs == runs


def test_files_that_extend_each_other_in_a_circle_are_refused(tmp_path: Path) -> None:
    write(tmp_path, "extends: b.yaml", "a.yaml")
    assert "circle" in complaint(write(tmp_path, "extends: a.yaml", "b.yaml"))


def test_merging_replaces_lists_and_joins_mappings() -> None:
    assert merged({"a": {"x": 1, "y": 2}, "l": [1, 2]}, {"a": {"y": 3}, "l": [4]}) == {
        "a": {"x": 1, "y": 3},
        "l": [4],
    }


@pytest.mark.parametrize(
    ("override", "text"),
    [
        ("evaluation.episdes=3", "episodes"),
        ("evaluation.episodes=0", "evaluation.episodes"),
        ("evaluation.episodes=many", "evaluation.episodes"),
        ("pilots.net.tkeover=1", "takeover"),
        ("pilots.net.kind=clonning", "'cloning'"),
        ("pilots.net.options.epocs=1", ": pilots.net.options.epocs: unknown key; did you mean 'epochs'?"),
        ("pilots.net.options.epochs=-1", ": pilots.net.options.epochs: must be at least 1"),
        ("pilots.net.disturbances=calm", "drop the key"),
        ("pilots.scripted.runs=3", "drop the key"),
        ("targets.success.nett={calm: 0.5}", "no pilot 'nett'"),
        ("targets.success.net={clam: 0.5}", "targets.success.net: level 'clam' is not in evaluation.levels"),
        ("evaluation.levels=[calm, calm]", "same name"),
        ("step=.nan", "step"),
        ("name=../elsewhere", "name"),
        ("name=my first try", "name: 'my first try' may have letters, digits, _, . and - of ASCII only"),
        ("pilots={a/b: {kind: scripted}}", "'a/b' may have letters, digits, spaces, _, . and -, a letter"),
        ("pilots={'a ': {kind: scripted}}", "'a ' may have letters, digits, spaces, _, . and -, a letter"),
        (f"pilots={{{'ü' * 51}: {{kind: scripted}}}}", "no space last, 100 bytes at most"),
        ("evaluation.levels=calm", "evaluation.levels: must be a list, not 'calm'"),
        ("evaluation.levels=[]", "evaluation.levels: must have 1 or more entries, not 0\n"),
        (f"name={'a' * 101}", "name: must have 100 or fewer characters"),
        ("boat=3", "boat: must be text, not 3"),
        ("evaluation.episodes='5'", "a whole number, not '5'; leave the quotation marks out"),
        ("evaluation.seed='1, 2'", "evaluation.seed: must be a whole number, not '1, 2'\n"),
        ("pilots.net=cloning", "pilots.net: must be a mapping of keys to values, not 'cloning'"),
        ("bounds.top=40.0", "bounds.top: must be 'south', 'north', 'west' or 'east', not 'top'"),
        ("reward.tim=1.0", "reward: no term 'tim'; did you mean 'time'? known here: progress"),
        ("data.folder=[monday, tuesday]", "data.folder: names one dataset; join several: swamp-rl"),
    ],
)
def test_a_wrong_value_or_key_is_named_with_what_is_allowed(tmp_path: Path, override: str, text: str) -> None:
    message = complaint(write(tmp_path, SMALL), override)
    assert all(line.startswith(f"override {clipped(override)[:30]}") for line in message.split("\n"))
    assert text in f"{message}\n"


def test_a_boat_file_and_runs_in_place_of_what_is_needed_are_reported_in_one_line(tmp_path: Path) -> None:
    boat = find_config("boats", "swamp")
    assert complaint(boat) == (
        f"{boat}: is a boat file; an experiment file is needed here, whose key boat names this one"
    )
    (tmp_path / "run.csv").write_text("time\n")
    message = "is a file, not a folder of runs; swamp-rl runs import makes one of a log"
    with pytest.raises(UserError, match=f"run.csv: {message}"):
        with_data_hash(load_experiment("smoke", f"data.folder={tmp_path / 'run.csv'}"), "smoke")
    with pytest.raises(UserError, match=r"smoke: data\.folder: nowhere: no such folder"):
        with_data_hash(load_experiment("smoke", "data.folder=nowhere"), "smoke")


def test_of_several_overrides_the_one_at_fault_is_named_and_a_wrong_file_before_any(tmp_path: Path) -> None:
    sound = ["evaluation.episodes=3", "evaluation.seed=5"]
    wrong = complaint(write(tmp_path, SMALL), sound[0], "evaluation.episdes=3", sound[1])
    assert wrong.startswith("override evaluation.episdes=3: evaluation.episdes: unknown key")
    together = complaint(write(tmp_path, SMALL), "targets.success.net.calm=0.5", "evaluation.levels=[severe]")
    assert together.startswith(
        "override evaluation.levels=[severe]: targets.success.net: level 'calm' is not in"
    )
    both = complaint(write(tmp_path, SMALL), "evaluation.episodes=0", "evaluation.seed=-1")
    assert [line[: line.index(": ")] for line in both.split("\n")] == [
        "override evaluation.episodes=0",
        "override evaluation.seed=-1",
    ]
    file = write(tmp_path, SMALL.replace("seed", "sede"))
    assert all(line.startswith(f"{file}: ") for line in complaint(file, *sound).split("\n"))


def test_targets_at_levels_that_are_no_longer_evaluated_are_left_out(tmp_path: Path) -> None:
    file = write(tmp_path, SMALL.replace("[calm]", "[calm, severe]") + TARGETS)
    assert load_experiment(file).targets.success == {"net": {"calm": 0.5, "severe": 0.1}}
    fewer = load_experiment(file, ["evaluation.levels=[calm]"])
    assert fewer.targets.success == {"net": {"calm": 0.5}}
    assert fewer.targets.smoother_than_data == ("net",)
    above = write(tmp_path, "extends: small.yaml\nevaluation: {levels: [standard]}", "above.yaml")
    assert load_experiment(above).targets.success == {}


def test_a_target_given_beside_the_levels_and_at_none_of_them_is_refused(tmp_path: Path) -> None:
    file = write(tmp_path, SMALL + TARGETS)
    assert "targets.success.net: level 'severe' is not in evaluation.levels" in complaint(file)
    asked = ["evaluation.levels=[severe]", "targets.success.net.calm=0.9"]
    assert "targets.success.net: level 'calm' is not in evaluation.levels" in complaint(file, *asked)


def test_a_pilot_set_to_null_is_dropped_with_its_targets() -> None:
    left = load_experiment("camogli", ["pilots.ppo=null"])
    assert "ppo" not in left.pilots and len(left.pilots) == 5
    assert list(left.targets.success) == ["reservoir", "cloning"]
    assert left.targets.smoother_than_data == ("reservoir", "cloning")


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (
            ["pilots.pppo=null"],
            "override pilots.pppo=null: pilots.pppo: no such pilot to drop; did you mean 'ppo'?",
        ),
        (["pilots.ppo=null", "targets.success.ppo.calm=0.5"], "targets: no pilot 'ppo'"),
        (["pilots.ppo=null", "pilots.ppo.runs=5"], "pilots.ppo.kind: is missing"),
    ],
)
def test_a_pilot_that_cannot_be_dropped_is_reported(overrides: list[str], message: str) -> None:
    with pytest.raises(UserError) as error:
        load_experiment("camogli", overrides)
    assert message in str(error.value)


def test_a_target_set_to_null_is_dropped(tmp_path: Path) -> None:
    file = write(tmp_path, SMALL.replace("[calm]", "[calm, severe]") + TARGETS)
    without = load_experiment(file, ["targets.success.net.calm=null"])
    assert without.targets.success == {"net": {"severe": 0.1}}
    assert load_experiment(file, ["targets.success.net=null"]).targets.success == {}


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("boat=swmp", "boat: no boat file named 'swmp'; did you mean 'swamp'?"),
        ("course=mine.yaml", "course: mine.yaml: no such file"),
        ("evaluation.levels=[calm, standrd]", "evaluation.levels: no disturbance file named 'standrd'"),
        ("evaluation={levels: [clam], episodes: 3}", "evaluation.levels: no disturbance file named 'clam'"),
        ("data.record.disturbances=stormy", "data.record.disturbances: no disturbance file named 'stormy'"),
        ("pilots.net={kind: ppo, disturbances: svere}", "pilots.net.disturbances: no disturbance file"),
    ],
)
def test_a_file_that_is_not_there_is_named_with_its_key(tmp_path: Path, override: str, message: str) -> None:
    small = write(tmp_path, f"{SMALL}\ntargets: {{success: {{net: {{calm: 0.5}}}}}}")
    assert complaint(small, override).startswith(f"override {override}: {message}")


@pytest.mark.parametrize(
    ("key", "wrong"),
    [
        ("boat: swmp", "boat"),
        ("course: mine.yaml", "course"),
        ("evaluation: {levels: [clm]}", "evaluation.levels"),
    ],
)
def test_a_wrong_boat_course_or_level_is_reported_with_the_experiments_file(
    tmp_path: Path, key: str, wrong: str
) -> None:
    base = write(tmp_path, SMALL, "base.yaml")
    file = write(tmp_path, f"extends: {base}\n{key}\n")
    assert complaint(file).startswith(f"{file}: {wrong}: ")


def test_a_fault_is_reported_with_the_extended_file_that_has_it(tmp_path: Path) -> None:
    sound = write(tmp_path, SMALL)
    base = write(tmp_path, f"extends: {sound}\nevaluation: {{episdes: 3}}\n", "base.yaml")
    top = write(tmp_path, f"extends: {base}\nname: top\n", "top.yaml")
    message = f"{base}: evaluation.episdes: unknown key; did you mean 'episodes'?"
    assert complaint(top).startswith(message)
    assert complaint(top, "evaluation.seed=5").startswith(message)
    write(tmp_path, f"extends: {sound}\nevaluation: {{episodes: 3}}\n", "base.yaml")
    top.write_text(f"extends: {base}\nevaluation: {{sed: 3}}\n")
    assert complaint(top).startswith(f"{top}: evaluation.sed: unknown key")


def test_an_experiment_that_extends_one_that_is_not_there_is_named(tmp_path: Path) -> None:
    message = complaint(write(tmp_path, "extends: camoglii"))
    assert message.startswith(f"{tmp_path / 'small.yaml'}: extends: no experiment file named 'camoglii'")


@pytest.mark.parametrize("override", ["episodes", "=3", "a..b=3", "a=[1"])
def test_a_malformed_override_is_quoted(tmp_path: Path, override: str) -> None:
    assert f"override {override}" in complaint(write(tmp_path, SMALL), override)


def test_a_missing_key_a_missing_file_and_malformed_yaml_are_distinguished(tmp_path: Path) -> None:
    assert "evaluation" in complaint(write(tmp_path, SMALL.replace("evaluation", "x-evaluation")))
    assert "no such file" in complaint(tmp_path / "absent.yaml")
    assert "line 2" in complaint(write(tmp_path, "name: a\nboat: }", "broken.yaml"))
