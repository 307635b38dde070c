"""The command line: what each verb prints, and one clear line with a non-zero exit for whatever is wrong."""

import errno
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import swamp_rl.experiments.cli
from swamp_rl.experiments.cli import app as cli

from swamp_rl import __version__
from swamp_rl.boat import load_boat
from swamp_rl.runs import Run, RunMeta, append_run, read_dataset, read_run, write_run
from swamp_rl.simulator import replay
from tests.support.command_line import COMMAND, Call, assert_complains
from tests.support.patience import PATIENCE
from tests.support.runs import circling

VERBS = ("run", "simulate", "record", "record-scripted", "bench", "runs", "demo")
ROOT = Path(__file__).parents[3]
HEAVY = ("torch", "starlette", "matplotlib", "numba", "pyarrow", "scipy", "reservoirpy", "rerun")


def separately(*words: object, **options: object) -> subprocess.CompletedProcess[str]:
    """The command line in a process of its own."""
    return subprocess.run(
        [COMMAND, *map(str, words)], capture_output=True, text=True, timeout=PATIENCE, **options
    )


def test_help_lists_the_verbs_and_version_is_the_packages(call: Call) -> None:
    code, out, _ = call("--help")
    assert code == 0
    assert all(verb in out for verb in VERBS)
    assert call("--version") == (0, f"swamp-rl {__version__}\n", "")


def test_help_says_the_units_of_angles(call: Call) -> None:
    _, out, _ = call("trial", "zig-zag", "--help")
    assert "(deg)" in out


def test_without_a_verb_the_help_is_printed() -> None:
    called = separately()
    assert called.returncode == cli.BAD_INPUT
    assert "record-scripted" in called.stdout
    assert called.stderr == ""


def test_help_waits_for_no_heavy_library() -> None:
    look = "sys.argv[1:] = ['--help']\ntry: main()\nexcept SystemExit: pass\n"
    check = f"print([name for name in {HEAVY} if name in sys.modules], file=sys.stderr)"
    script = f"import sys\nfrom swamp_rl.experiments.cli import main\n{look}{check}"
    called = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=PATIENCE)
    assert called.stderr == "[]\n"


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["dance"], "No such command 'dance'"),
        (["run"], "Missing argument"),
        (["run", "a", "--fast"], "No such option"),
        (["evaluate", "a", "--episodes", "many"], "'--episodes': must be a whole number, not 'many'"),
        (["evaluate", "a", "--episodes", "1.5"], "must be a whole number, not '1.5' (see"),
        (["evaluate", "a", "--episodes", "0"], "'--episodes': must be at least 1"),
        (["runs", "export", "a", "--to", "xls", "--out", "b"], "'--to': 'xls' is not one of 'minari', "),
        (["simulate"], "Missing option"),
        (["simulate", "--commands", "a.csv"], "Missing option '--out'"),
        (["record-scripted"], "Missing option '--out'"),
        (["record-scripted", "--out", "a", "--count", "0"], "--count"),
        (["record-scripted", "--out", "a", "--seed", "x"], "--seed"),
        (["record"], "Missing option '--out'"),
        (["record", "--out", "a", "--port", "70000"], "--port"),
        (["record", "--out", "a", "--host", "0.0.0.0"], "add --token"),
        (["record", "--out", "a", "--host", "0.0.0.0", "--token", "no"], "letters and digits"),
        (["bench", "now"], "unexpected extra argument"),
        (["bench", "--out", "."], "--out .: end the name in .json"),
        (["simulate", "--commands", ".", "--out", "a.csv"], ".: is a folder; name the .csv or .parquet"),
        (["runs", "check"], "Missing argument"),
        (["runs", "show"], "Missing argument"),
        (["runs", "export", "runs"], "Missing option '--to'. Choose from: minari, lerobot, mcap"),
        (["runs", "dance"], "No such command"),
        (["runs", "check"], "(see swamp-rl runs check --help)"),
        (["dance"], "(see swamp-rl --help)"),
        (["trial", "zig-zag", "--angle"], "(see swamp-rl trial zig-zag --help)"),
        (["export", "cloning", "--out", "a.txt"], "--out a.txt: end the name in .onnx"),
        (["runs", "show", "a", "--out", "a.jpg"], "end the name in .png"),
    ],
)
def test_wrong_arguments_are_one_line(call: Call, words: list[str], part: str) -> None:
    assert_complains(call(*words), part)


@pytest.mark.parametrize(
    "words",
    [
        ["run", "nowhere.yaml"],
        ["run", "nowhere"],
        ["simulate", "--commands", "nowhere.csv", "--out", "a.csv"],
        ["simulate", "--commands", "nowhere.csv", "--out", "a.csv", "--boat", "nowhere"],
        ["record-scripted", "--out", "a", "--course", "nowhere"],
        ["record-scripted", "--out", "a", "--boat", "nowhere.yaml"],
        ["record", "--out", "a", "--course", "nowhere"],
        ["record", "--out", "a", "--boat", "nowhere"],
        ["record", "--out", "a", "--disturbances", "nowhere"],
        ["record", "--out", "a", "--pilot", "nowhere"],
        ["runs", "check", "nowhere"],
        ["runs", "show", "nowhere"],
        ["diagnose", "nowhere", "--out", "a"],
    ],
)
def test_what_does_not_exist_is_named_and_nothing_is_written(call: Call, words: list[str]) -> None:
    assert_complains(call(*words), "nowhere")
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize("words", [["runs", "check"], ["evaluate"], ["boat", "check"]])
def test_a_name_with_a_line_end_is_reported_on_one_line(call: Call, words: list[str]) -> None:
    assert_complains(call(*words, "no\nsuch"), "no such")


def test_check_of_a_good_folder_says_so(call: Call, folder: Path) -> None:
    assert call("runs", "check", folder) == (0, f"{folder}: 2 runs, 62 rows, no faults\n", "")


def test_check_names_every_fault_and_fails(call: Call, folder: Path) -> None:
    table = (folder / "one.csv").read_text().splitlines()
    table[4] = table[4].replace(table[4].split(",")[1], "nan", 1)
    table[9] = "abc" + table[9][table[9].index(",") :]
    (folder / "one.csv").write_text("\n".join(table) + "\n")
    (folder / "two.parquet").write_bytes(b"PAR1")
    code, out, _ = call("runs", "check", folder)
    assert code == 1
    assert "one.csv: row 4 (line 5), column north: nan is not a finite number" in out
    assert "one.csv: row 9 (line 10), column time: 'abc' is not a number" in out
    assert "two.parquet: cannot be read" in out
    assert out.splitlines()[-1].endswith("3 faults")


def test_check_reports_unknown_columns_without_failing(call: Call, folder: Path) -> None:
    append_run(folder, Run("three", circling() | {"salinity": np.ones(31)}))
    code, out, _ = call("runs", "check", folder)
    assert code == 0
    assert "note: three.parquet: column salinity" in out


def test_show_prints_each_run_and_draws_a_png(call: Call, folder: Path) -> None:
    append_run(folder, Run("three", circling(), RunMeta(outcome="success")))
    code, out, _ = call("runs", "show", folder)
    assert code == 0
    for word in ("one", "two", "three", "buoy", "1.5", "2 of 3 runs"):
        assert word in out
    assert Path("results/runs-tracks.png").read_bytes().startswith(b"\x89PNG")


def test_show_of_runs_without_outcomes_and_seeds_has_no_column_for_them(call: Call, folder: Path) -> None:
    (folder / "dataset.yaml").unlink()
    code, out, _ = call("runs", "show", folder, "--boat", "swamp")
    assert code == 0 and "distance" in out
    assert not any(word in out for word in ("outcome", "seed", "successful"))


@pytest.mark.parametrize("course", ["camogli", "nowhere-known"])
def test_show_draws_where_it_is_reported_whether_or_not_it_knows_the_course(
    call: Call, folder: Path, course: str
) -> None:
    text = (folder / "dataset.yaml").read_text()
    (folder / "dataset.yaml").write_text(text.replace("course: camogli", f"course: {course}"))
    assert call("runs", "show", folder, "--out", "a/b.png")[0] == 0
    assert Path("a/b.png").read_bytes().startswith(b"\x89PNG")


def test_show_of_a_faulty_folder_is_one_line(call: Call, folder: Path) -> None:
    (folder / "one.csv").write_text("time,north\n")
    assert_complains(call("runs", "show", folder), "one.csv", "more: swamp-rl runs check")


def test_an_empty_dataset_is_one_line(call: Call, folder: Path) -> None:
    text = (folder / "dataset.yaml").read_text()
    (folder / "dataset.yaml").write_text(text[: text.index("runs:")])
    for name in ("one.csv", "two.parquet"):
        (folder / name).unlink()
    assert_complains(call("runs", "show", folder), "lists no runs")


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_simulate_writes_the_track_that_replay_predicts(call: Call, folder: Path, kind: str) -> None:
    words = ["simulate", "--boat", "swamp-light", "--commands", folder / "one.csv", "--out", f"a.{kind}"]
    assert call(*words)[0] == 0
    expected = replay.replay(load_boat("swamp-light"), read_run(folder / "one.csv"))
    written = read_run(Path(f"a.{kind}"))
    assert {name: values.tobytes() for name, values in written.columns.items()} == {
        name: np.ascontiguousarray(values).tobytes() for name, values in expected.columns.items()
    }


def test_simulate_takes_the_boat_of_the_runs_dataset_where_none_is_given(call: Call, tmp_path: Path) -> None:
    assert call("record-scripted", "--count", "1", "--boat", "swamp-light", "--out", "light")[0] == 0
    run = next(Path("light").glob("run*"))
    shutil.copy(run, tmp_path / "alone.parquet")
    for out, words in {
        "own": (run,),
        "named": (run, "--boat", "swamp-light"),
        "lone": (tmp_path / "alone.parquet",),
        "swamp": (run, "--boat", "swamp"),
    }.items():
        assert call("simulate", "--out", f"{out}.csv", "--commands", *words)[0] == 0
    assert Path("own.csv").read_bytes() == Path("named.csv").read_bytes()
    assert Path("lone.csv").read_bytes() == Path("swamp.csv").read_bytes()
    assert Path("own.csv").read_bytes() != Path("swamp.csv").read_bytes()


def test_simulate_of_a_run_without_commands_is_one_line(call: Call, tmp_path: Path) -> None:
    track = {name: circling()[name] for name in ("time", "north", "east", "heading")}
    write_run(tmp_path / "track.csv", Run("track", track))
    words = ["simulate", "--commands", "track.csv", "--out", "a.csv"]
    assert_complains(call(*words), "throttle_bs is missing")
    assert not Path("a.csv").exists()


def test_simulate_of_an_impossible_boat_is_one_line(call: Call, folder: Path) -> None:
    Path("heavy.yaml").write_text("extends: swamp\nname: heavy\nmass: -5.0\n")
    words = ["simulate", "--commands", folder / "one.csv", "--out", "a.csv", "--boat", "heavy.yaml"]
    assert_complains(call(*words), "heavy.yaml", "mass")


def test_simulate_writes_neither_other_kinds_of_file_nor_where_it_may_not(call: Call, folder: Path) -> None:
    words = ["simulate", "--commands", folder / "one.csv", "--out"]
    assert_complains(call(*words, "a.txt"), "a.txt", ".parquet")
    Path("file.csv").touch()
    assert_complains(call(*words, Path("file.csv", "b.csv")), "file.csv", "folder is needed")


def test_a_file_that_cannot_grow_is_one_line_and_leaves_nothing(folder: Path, tmp_path: Path) -> None:
    def small() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))

    out = tmp_path / "out"
    called = separately(
        *("runs", "show", folder, "--out", out / "tracks.png"),
        preexec_fn=small,
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
    )
    assert called.returncode == cli.BAD_INPUT
    # Matplotlib may say before that it cannot keep its list of fonts.
    assert called.stderr.splitlines()[-1].startswith(f"swamp-rl: {out}/tracks.png: File too large; ")
    assert list(out.iterdir()) == []


def test_recorded_runs_are_scripted_sound_and_the_same_for_the_same_seed(call: Call) -> None:
    words = ["record-scripted", "--count", "3", "--failed", "0", "--seed", "4", "--out"]
    assert all(call(*words, name)[0] == 0 for name in ("a", "b"))
    one, other = read_dataset("a"), read_dataset("b")
    assert one.meta.source == "scripted"
    assert len(one.successful) == 3
    assert [run.columns["north"].tobytes() for run in one.runs] == [
        run.columns["north"].tobytes() for run in other.runs
    ]


def test_recording_never_replaces_a_folder(call: Call, folder: Path) -> None:
    assert_complains(call("record-scripted", "--out", folder), "already exists")
    assert len(read_dataset(folder).runs) == 2


def raising(error: BaseException) -> Callable[..., None]:
    def fail(*_: object, **__: object) -> None:
        raise error

    return fail


def test_a_full_disk_or_memory_is_one_line(call: Call, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    full = OSError(errno.ENOSPC, "Full")
    for error, message in (full, "a.csv: Full; free some room"), (MemoryError(), "no memory is left; ask"):
        monkeypatch.setattr(os, "fsync", raising(error))
        assert_complains(call("simulate", "--commands", folder / "one.csv", "--out", "a.csv"), message)
        assert not Path("a.csv").exists()


def test_an_interrupted_verb_is_one_line_with_the_usual_exit_code(
    call: Call, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "fsync", raising(KeyboardInterrupt()))
    words = ["simulate", "--commands", folder / "one.csv", "--out", "a.csv"]
    assert_complains(call(*words), "interrupted", code=130)
    assert not Path("a.csv").exists()


def test_ctrl_c_while_the_verbs_are_imported_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delattr(swamp_rl.experiments.cli, "app")
    monkeypatch.delitem(sys.modules, cli.__name__)
    monkeypatch.setattr("importlib._bootstrap._find_spec", raising(KeyboardInterrupt()))
    with pytest.raises(SystemExit) as ended:
        swamp_rl.experiments.cli.main()
    assert ended.value.code == 130
    assert capsys.readouterr().err == "swamp-rl: interrupted before it began\n"


def test_ctrl_c_while_the_package_itself_is_imported_is_one_line(tmp_path: Path) -> None:
    interrupting = (  # a parent in the background has the signal ignored
        "import os, signal\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "os.kill(os.getpid(), signal.SIGINT)\n"
    )
    (tmp_path / "gymnasium.py").write_text(interrupting)  # the first library that the package imports
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    called = subprocess.run(
        [sys.executable, "-c", "from swamp_rl_command import main; main()", "--version"],
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert called.returncode == 130
    assert (called.stdout, called.stderr) == ("", "swamp-rl: interrupted before it began\n")


@pytest.mark.parametrize("way", [("-c", "from swamp_rl_command import main; main()"), ("-m", "swamp_rl")])
def test_the_installed_command_and_the_package_run_the_command_line(way: tuple[str, str]) -> None:
    start = [sys.executable, *way, "--version"]
    called = subprocess.run(start, capture_output=True, text=True, cwd=ROOT, timeout=PATIENCE)
    assert (called.returncode, called.stdout, called.stderr) == (0, f"swamp-rl {__version__}\n", "")


@pytest.mark.timed
def test_a_terminated_verb_is_one_line_and_leaves_nothing_half_written(
    call: Call, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def terminate(handle: int) -> None:
        os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr(os, "fsync", terminate)
    words = ["simulate", "--commands", folder / "one.csv", "--out", "out/a.csv"]
    assert_complains(call(*words), "terminated", code=143)
    assert list(Path("out").iterdir()) == []
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL


@pytest.mark.parametrize(
    ("number", "code", "word"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]
)
@pytest.mark.timed
def test_a_signal_that_a_callback_swallows_still_ends_the_verb(
    call: Call, monkeypatch: pytest.MonkeyPatch, number: int, code: int, word: str
) -> None:
    class Noisy:
        def __del__(self) -> None:
            os.kill(os.getpid(), number)

    def swallow(folder: Path, boat: str | None) -> None:
        noisy = Noisy()
        del noisy  # an exception in there goes nowhere
        time.sleep(PATIENCE)

    monkeypatch.setattr("swamp_rl.runs.inspect_dataset", swallow)
    assert_complains(call("runs", "check", "anywhere"), word, code=code)


def test_a_bug_is_one_line_for_users_and_a_traceback_for_those_who_ask(
    call: Call, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("swamp_rl.runs.inspect_dataset", raising(RuntimeError("two\nlines")))
    assert_complains(call("runs", "check", folder), "unexpected RuntimeError: two lines", code=70)
    monkeypatch.setenv(cli.DEBUG, "1")
    with pytest.raises(RuntimeError):
        call("runs", "check", folder)


@pytest.mark.timed
def test_output_may_be_cut_short_by_its_reader(folder: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    start = [COMMAND, "runs", "check", str(folder)]
    called = subprocess.run(start, stdout=writing, stderr=subprocess.PIPE, text=True, timeout=PATIENCE)
    os.close(writing)
    assert called.returncode == 1
    assert called.stderr == ""


def test_a_name_that_is_no_text_in_the_locale_is_one_line(call: Call) -> None:
    Path("l\udce4ufe").mkdir()
    for words in (("demo", "l\udce4ufe", "--html", "a.html"), ("runs", "show", "l\udce4ufe")):
        assert_complains(call(*words), "has bytes that are no text in utf-8", "LC_ALL=C.UTF-8", "rename")
