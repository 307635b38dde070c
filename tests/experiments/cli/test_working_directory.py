"""A stranger's folder as working directory: what lies in it is neither run nor taken for settings."""

import os
import subprocess
import sys
from pathlib import Path

import matplotlib
import pytest

from swamp_rl.demo.viewer import RERUN
from swamp_rl.figure_style import sheet
from swamp_rl.workers.processes import ProcessPool
from tests.support.command_line import Call, assert_complains

ROOT = Path(__file__).parents[3]
MODULES = ("multiprocessing", "rerun_cli", "runpy", "sitecustomize", "socket", "yaml")


@pytest.fixture
def hostile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory, with modules that leave a file `ran` when they are imported."""
    for name in MODULES:
        (tmp_path / f"{name}.py").write_text(
            f"open({str(tmp_path / 'ran')!r}, 'w').write('x')\nraise OSError"
        )
    monkeypatch.chdir(tmp_path)
    return tmp_path


def echoed(job: str) -> str:
    """A worker's work."""
    return job


def test_a_worker_imports_nothing_from_the_working_directory(hostile: Path) -> None:
    with ProcessPool(echoed, 1) as pool:
        pool.submit(7, "word")
        assert pool.wait() == (7, "word", "")
    assert not (hostile / "ran").exists()


def test_a_script_that_asks_for_workers_is_run_once(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "import os.path\n"
        "from swamp_rl.workers.pool import answers\n"
        "print(list(answers(os.path.basename, ['a/b', 'a/c'], 2)))\n"
    )
    done = subprocess.run([sys.executable, script], check=True, capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("['b', 'c']\n", "")


def test_rerun_is_not_looked_for_in_the_working_directory(hostile: Path) -> None:
    subprocess.run([*RERUN, "--version"], check=True, capture_output=True)
    assert not (hostile / "ran").exists()


def test_every_python_that_is_started_ignores_the_working_directory() -> None:
    sources = [path for name in ("swamp_rl", "experiments", "envs") for path in (ROOT / name).rglob("*.py")]
    starts = [line for path in sources for line in path.read_text().splitlines() if "sys.executable," in line]
    assert len(starts) > 1
    assert [line for line in starts if 'sys.executable, "-P"' not in line] == []


def test_settings_of_matplotlib_do_not_change_a_figure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def drawn(name: str) -> bytes:
        with sheet(tmp_path / name, 2.0, 1.5) as figure:
            figure.subplots().set(title="a_b", xlabel="east [m]")
        return (tmp_path / name).read_bytes()

    usual = drawn("usual.png")
    for key, value in {"text.usetex": True, "savefig.dpi": 20.0, "font.size": 30.0}.items():
        monkeypatch.setitem(matplotlib.rcParams, key, value)
    assert drawn("other.png") == usual
    assert matplotlib.rcParams["text.usetex"] is True


@pytest.mark.parametrize(
    ("name", "content"),
    [(".numba_config.yaml", b"disable_jit: 1\n"), (".numba_config.yaml", b"{: ["), ("matplotlibrc", b"\xff")],
)
def test_settings_of_libraries_in_the_working_directory_are_refused(
    name: str, content: bytes, call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / name).write_bytes(content)
    monkeypatch.chdir(tmp_path)
    code, out, err = call("boats")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert name in err


def test_a_working_directory_that_was_removed_is_reported(call: Call, tmp_path: Path) -> None:
    (tmp_path / "gone").mkdir()
    os.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    assert_complains(
        call("runs", "doctor", "../data"), "the working directory was removed; change to another"
    )


@pytest.mark.parametrize(
    ("name", "value"), [("DISABLE_JIT", "1"), ("NUM_THREADS", "0"), ("NUM_THREADS", "-2")]
)
def test_settings_of_numba_with_which_nothing_is_compiled_are_reported(
    call: Call, monkeypatch: pytest.MonkeyPatch, name: str, value: str
) -> None:
    monkeypatch.setenv(f"NUMBA_{name}", value)
    assert_complains(call("effects"), f"NUMBA_{name} is {value}: ", "unset this variable")


@pytest.mark.parametrize("value", ["abc", "-5", "9" * 20])
def test_a_date_that_libraries_do_not_read_is_refused_with_one_line(value: str, tmp_path: Path) -> None:
    done = in_an_environment(tmp_path, SOURCE_DATE_EPOCH=value)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1
    assert f"SOURCE_DATE_EPOCH is {value}: give seconds since 1970" in done.stderr


def test_a_backend_of_matplotlib_that_is_not_there_does_not_matter(tmp_path: Path) -> None:
    done = in_an_environment(tmp_path, MPLBACKEND="nonsense")
    assert (done.returncode, done.stderr) == (0, "")
    assert list((tmp_path / "hull").glob("*.png"))


def in_an_environment(folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """A verb that draws a figure, in a process of its own."""
    words = ["design", "hull", "swamp_hull", "--out", str(folder / "hull")]
    return subprocess.run(
        [sys.executable, "-P", "-m", "swamp_rl", *words],
        env=os.environ | variables,
        check=False,
        capture_output=True,
        text=True,
    )
