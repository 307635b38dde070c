"""`swamp-rl trial`: the verbs write runs and figures, and refuse what they cannot do in one line."""

import json
from pathlib import Path

import pytest
from swamp_rl.experiments.cli import app as cli

from swamp_rl.files import read_yaml, write_yaml
from swamp_rl.runs import Run, RunMeta, append_run, create_dataset, read_dataset
from tests.support.command_line import Call, assert_complains


def test_a_verb_writes_runs_figures_tables_and_json(call: Call) -> None:
    words = ["trial", "turning-circle", "--angle", "35", "--throttle", "0.6", "--turns", "2", "--out", "a"]
    code, out, error = call(*words)
    assert (code, error) == (0, "")
    assert "01-turning-circle-s35-60pc: advance " in out
    assert "IMO MSC.137(76), a standard for ships of 100 m and more: " in out
    assert len(read_dataset("a").runs) == 1
    found = json.loads(Path("a/analysis/analysis.json").read_text())
    assert found["runs"][0]["corrected"]["steady_diameter"]["unit"] == "m"
    report = Path("a/analysis/report.md").read_text()
    assert "MSC.137(76)" in report
    assert all(
        Path("a/analysis", name).read_bytes().startswith(b"\x89PNG")
        for name in ("circles.png", "diameters.png")
    )


def test_every_other_verb_runs_and_draws_its_picture(call: Call) -> None:
    common = ["--throttle", "0.9", "--boat", "swamp-light"]
    for name, more, picture in (
        ("zig-zag", ["--angle", "20", "--executes", "3"], "overshoots.png"),
        ("stopping", [], "stopping.png"),
        ("straight", ["--duration", "3"], "straight.png"),
        ("pull-out", ["--angle", "20", "--duration", "20"], "pull_out.png"),
        ("spiral", ["--angle", "20"], "spiral.png"),
        ("reverse-spiral", ["--angle", "20"], "reverse_spiral.png"),
    ):
        code, _, error = call("trial", name, *common, *more, "--out", name)
        assert (code, error) == (0, ""), (name, error)
        assert Path(name, "analysis", picture).is_file()


def test_analyse_gives_the_same_figures_again_and_elsewhere(call: Call) -> None:
    assert call("trial", "stopping", "--throttle", "0.6", "--out", "a")[0] == 0
    code, _, _ = call("trial", "analyse", "a", "--out", "b")
    assert code == 0
    assert Path("b/analysis.json").read_text() == Path("a/analysis/analysis.json").read_text()


def test_a_plan_takes_another_boat(call: Call) -> None:
    Path("p.yaml").write_text("name: p\nboat: swamp\ntrials: [{manoeuvre: stopping, throttle: [0.5]}]\n")
    assert call("trial", "plan", "p.yaml", "--boat", "swamp-light", "--out", "a")[0] == 0
    assert read_dataset("a").meta.vehicle == "swamp-light"


def test_the_boat_of_a_plan_is_read_once_and_once_for_its_copy(
    call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_yaml("b.yaml", {"extends": "swamp"})
    Path("p.yaml").write_text("name: p\nboat: b.yaml\ntrials: [{manoeuvre: stopping, throttle: [0.5]}]\n")
    read: list[Path] = []
    monkeypatch.setattr("swamp_rl.boat.load.read_yaml", lambda file: (read.append(file), read_yaml(file))[1])
    assert call("trial", "plan", "p.yaml", "--out", "a")[0] == 0
    assert read.count(Path("b.yaml")) == 2


def test_a_measured_track_alone_is_analysed_once_its_manoeuvre_and_marks_are_reported(call: Call) -> None:
    Path("p.yaml").write_text(
        "name: p\nboat: swamp\ntrials:\n"
        "  - {manoeuvre: turning-circle, angle_deg: [40.0], throttle: [0.6], turns: 2}\n"
        "  - {manoeuvre: zig-zag, angle_deg: [20.0], throttle: [0.6]}\n"
    )
    assert call("trial", "plan", "p.yaml", "--out", "a")[0] == 0
    recorded = read_dataset("a")
    create_dataset("b", recorded.meta.model_copy(update={"source": "measured", "runs": []}))
    for run in recorded.runs:
        track = {name: run.columns[name] for name in ("time", "north", "east", "heading")}
        extra = run.meta.model_extra or {}
        entries = {"manoeuvre": extra["manoeuvre"]["kind"], "marks": extra["marks"]}
        append_run("b", Run(run.name, track, RunMeta.model_validate(entries)))
    code, _, error = call("trial", "analyse", "b")
    assert (code, error) == (0, "")
    one, other = (json.loads(Path(x, "analysis/analysis.json").read_text())["runs"] for x in ("a", "b"))
    for i, name in ((0, "advance"), (1, "first_overshoot")):
        assert other[i]["figures"][name]["value"] == pytest.approx(one[i]["figures"][name]["value"], rel=1e-6)


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (["trial", "waltz"], ["No such command"]),
        (["trial", "turning-circle", "--throttle", "0.6", "--out", "a"], ["Missing option '--angle'"]),
        (["trial", "turning-circle", "--angle", "30", "--throttle", "0.6"], ["Missing option '--out'"]),
        (
            ["trial", "turning-circle", "--angle", "130", "--throttle", "0.6", "--out", "a"],
            ["--angle", "90"],
        ),
        (["trial", "turning-circle", "--angle", "x", "--throttle", "0.6", "--out", "a"], ["--angle"]),
        (["trial", "zig-zag", "--angle", "20", "--throttle", "60", "--out", "a"], ["throttle", "at most 1"]),
        (["trial", "zig-zag", "--angle", "0", "--throttle", "0.6", "--out", "a"], ["0 steers nowhere"]),
        (
            ["trial", "zig-zag", "--angle", "20", "--throttle", "0.6", "--pattern", "odd", "--out", "a"],
            ["pattern"],
        ),
        (["trial", "stopping", "--throttle", "0.6", "--boat", "nowhere", "--out", "a"], ["nowhere"]),
        (
            [
                "trial",
                "turning-circle",
                "--angle",
                "60",
                "--throttle",
                "0.6",
                "--boat",
                "esso_osaka",
                "--out",
                "a",
            ],
            ["35.4"],
        ),
        (["trial", "plan", "nowhere", "--out", "a"], ["nowhere", "ittc_swamp"]),
        (["trial", "analyse", "nowhere"], ["nowhere"]),
    ],
)
def test_wrong_arguments_are_one_line_and_leave_nothing(
    call: Call, words: list[str], parts: list[str]
) -> None:
    assert_complains(call(*words), *parts, code=cli.BAD_INPUT)
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ("turning-circle --angle 400 --throttle 0.5", "swamp-rl: --angle: must be at most 90"),
        ("straight --throttle 0.5 --throttle 7", "swamp-rl: --throttle: must be at most 1"),
        ("stopping --throttle 0.5 --start-speed -3", "swamp-rl: --start-speed: must be greater than"),
        (
            "zig-zag --angle 9 --throttle 0.5 --heading 3 --heading 4",
            "--heading: give one for each of --angle",
        ),
    ],
)
def test_a_wrong_value_is_reported_by_its_option(call: Call, asked: str, message: str) -> None:
    assert_complains(call("trial", *asked.split(), "--out", "a"), message, code=cli.BAD_INPUT)


def test_a_dataset_without_a_trial_is_one_line(call: Call, folder: Path) -> None:
    assert_complains(call("trial", "analyse", folder), "no turning circle or zig-zag found")
    assert not (folder / "analysis").exists()


def test_a_trial_never_replaces_what_is_no_trial(call: Call) -> None:
    Path("a").mkdir()
    Path("a/letter.txt").write_text("dear reader")
    assert_complains(call("trial", "stopping", "--throttle", "0.6", "--out", "a"), "already exists")


def test_commands_of_a_run_are_sailed_again_as_a_dataset(call: Call) -> None:
    assert call("trial", "straight", "--throttle", "0.6", "--duration", "3", "--out", "a")[0] == 0
    (run,) = read_dataset("a").runs
    file = next(Path("a").glob("*.parquet"))
    code, out, error = call("trial", "commands", file, "--out", "b")
    assert (code, error) == (0, "")
    assert "b: 1 run" in out
    (again,) = read_dataset("b").runs
    assert again.pose == pytest.approx(run.pose, abs=1e-6)


def test_commands_of_another_boat_are_one_line_and_leave_nothing(call: Call) -> None:
    assert call("trial", "straight", "--throttle", "0.6", "--duration", "3", "--out", "a")[0] == 0
    file = next(Path("a").glob("*.parquet"))
    words = ["trial", "commands", file, "--boat", "esso_osaka", "--out", "b"]
    assert_complains(call(*words), "propeller_main")
    assert_complains(call("trial", "commands", "nowhere.csv", "--out", "b"), "nowhere.csv")
    assert not Path("b").exists()
