"""What is installed works on its own: the wheel carries YAML and command, and works beside strangers."""

import os
import pty
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

from swamp_rl.physics.compile import cache_folder
from tests.support.patience import PATIENCE

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("install")]  # what they share is made once

CHECKOUT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of this checkout."""
    pytest.importorskip("hatchling")
    made = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(made)]
    subprocess.run(build, cwd=CHECKOUT, check=True, capture_output=True, timeout=PATIENCE)
    (found,) = made.glob("*.whl")
    return found


@pytest.fixture(scope="module")
def installed(wheel: Path) -> Path:
    """A folder with the unpacked wheel."""
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(wheel.parent / "site")
    return wheel.parent / "site"


class Stranger:
    """Somebody's folder with `envs` and `experiments` of their own, and an environment with the wheel in it.

    The environment is new and pip installs the wheel into it, but not its dependencies, which are gigabytes:
    a path file lends those of the tests' interpreter, behind the environment's own packages. Path files in
    there, such as that of an editable checkout, are not read. What the dependencies' own installation would
    break is not seen.
    """

    def __init__(self, folder: Path, wheel: Path) -> None:
        self.home, self.bin = folder / "home", folder / "venv" / "bin"
        self.clean = {"PATH": os.environ["PATH"], "HOME": str(self.home), "PYTHONPATH": "."}
        cache = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
        self.compiled = self.clean | {"XDG_CACHE_HOME": cache}  # what the tests compile is lent too
        venv.create(folder / "venv", with_pip=False)
        install = ["-m", "pip", "--python", str(self.bin / "python"), "install", "--no-deps", "--no-index"]
        self._run(sys.executable, *install, "--quiet", str(wheel), cwd=folder)
        (self.site,) = (folder / "venv").glob("lib/python3*/site-packages")
        self.own = {path.name for path in self.site.iterdir()}
        (self.site / "lent.pth").write_text(f"{sysconfig.get_path('purelib')}\n")
        for package in ("envs", "experiments"):
            (self.home / package).mkdir(parents=True)
            (self.home / package / "__init__.py").write_text("raise SystemExit('the stranger is imported')")

    def python(self, program: str) -> str:
        return self._run(str(self.bin / "python"), "-c", program)

    def swamp_rl(self, *words: str) -> str:
        return self._run(str(self.bin / "swamp-rl"), *words)

    def error_of_a_terminal(self, *words: str) -> bytes:
        """What a command writes to the error stream, where that is a terminal and no machine code is lent."""
        ours, theirs = pty.openpty()
        with os.fdopen(ours, "rb", 0) as message, os.fdopen(theirs, "wb", 0) as terminal:
            command = [str(self.bin / "swamp-rl"), *words]
            subprocess.run(
                command, cwd=self.home, env=self.clean, stdout=subprocess.DEVNULL, stderr=terminal, check=True
            )
            os.set_blocking(ours, False)
            return message.read(65536) or b""

    def _run(self, *words: str, cwd: Path | None = None) -> str:
        done = subprocess.run(
            words, cwd=cwd or self.home, env=self.compiled, capture_output=True, text=True, timeout=PATIENCE
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout


@pytest.fixture(scope="module")
def stranger(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Stranger:
    return Stranger(tmp_path_factory.mktemp("stranger"), wheel)


def test_the_wheel_holds_every_config(installed: Path) -> None:
    def files(folder: Path) -> set[str]:
        found = (path for path in folder.rglob("*") if path.is_file())
        return {str(path.relative_to(folder)) for path in found}

    assert files(installed / "swamp_rl" / "configs") == files(CHECKOUT / "configs")


def test_the_wheel_holds_the_recorders_page(installed: Path) -> None:
    page = Path("swamp_rl/teleop/page")
    carried = {path.name for path in (installed / page).iterdir()}
    assert {"index.html", "style.css", "main.js"} <= carried
    assert carried == {path.name for path in (CHECKOUT / page).iterdir()}


def test_the_wheel_holds_one_package_and_the_command(installed: Path) -> None:
    (info,) = installed.glob("*.dist-info")
    assert {path.name for path in installed.iterdir()} == {"swamp_rl", "swamp_rl_command.py", info.name}
    assert (installed / "swamp_rl" / "envs" / "single.py").is_file()
    assert (installed / "swamp_rl" / "experiments" / "cli" / "app.py").is_file()
    assert "swamp-rl = swamp_rl_command:main" in (info / "entry_points.txt").read_text()


def test_an_installed_package_finds_its_configs_by_name(installed: Path, tmp_path: Path) -> None:
    script = "from swamp_rl.files import find_config; print(find_config('boats', 'swamp'))"
    found = subprocess.run(
        [sys.executable, "-c", script],
        cwd=tmp_path,
        env={"PYTHONPATH": str(installed)},
        capture_output=True,
        text=True,
        check=True,
        timeout=PATIENCE,
    )
    assert Path(found.stdout.strip()) == installed / "swamp_rl" / "configs" / "boats" / "swamp.yaml"


def test_an_environment_gets_one_package_its_command_and_no_path_file(stranger: Stranger) -> None:
    own = {name for name in stranger.own if not name.endswith(".dist-info")}
    assert own - {"__pycache__"} == {"swamp_rl", "swamp_rl_command.py"}


def test_beside_a_strangers_packages_the_wheels_own_are_imported(stranger: Stranger) -> None:
    assert stranger.python("print('started')") == "started\n"
    found = stranger.python(
        "import gymnasium, swamp_rl, swamp_rl.experiments.cli as cli\n"
        "env = gymnasium.make('swamp/Gates-v1')\n"
        "import swamp_rl.envs.single as single\n"
        "print(swamp_rl.__file__, cli.__file__, single.__file__, sep='\\n')\n"
        "print(env.reset(seed=0)[0].shape == env.observation_space.shape)"
    ).splitlines()
    assert found[-1] == "True"
    assert len(found) == 4 and all(Path(file).is_relative_to(stranger.site) for file in found[:3])


def test_the_wheel_and_the_checkout_it_was_built_from_have_the_same_machine_code(stranger: Stranger) -> None:
    output = stranger.python("from swamp_rl.physics import compile; print(compile.cache_folder())")
    assert output == f"{cache_folder()}\n"


def test_the_first_use_says_at_a_terminal_that_it_compiles_and_the_second_does_not(
    stranger: Stranger, folder: Path
) -> None:
    assert stranger.error_of_a_terminal("courses") == b""  # simulates nothing
    words = ["simulate", "--commands", str(folder / "one.csv"), "--out"]  # compiles the least
    first = stranger.error_of_a_terminal(*words, "first.csv")
    assert first.startswith(b"swamp-rl: compiling the simulator") and len(first.splitlines()) == 1
    assert stranger.error_of_a_terminal(*words, "second.csv") == b""


def test_beside_a_strangers_packages_an_experiment_a_demo_and_a_diagnosis_run(stranger: Stranger) -> None:
    stranger.swamp_rl("run", "smoke", "--set", "smoke=true", "--out", "results")
    assert (stranger.home / "results" / "report.md").is_file()
    output = stranger.swamp_rl("demo", "--html", "shipped.html")
    assert "1 scripted, 1 cloning, 1 reservoir, 1 line-of-sight; same start, same weather" in output
    assert (stranger.home / "shipped.html").stat().st_size > 10_000
    stranger.swamp_rl("trial", "zig-zag", "--angle", "20", "--throttle", "0.6", "--out", "sea")
    output = stranger.swamp_rl("diagnose", "sea", "--boat", "swamp", "--out", "diagnosis")
    assert "\nverdict: " in output
    assert (stranger.home / "diagnosis" / "report.html").is_file()
