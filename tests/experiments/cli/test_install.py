"""What is installed works on its own: the wheel carries the YAML and the command."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

CHECKOUT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the unpacked wheel of this checkout."""
    pytest.importorskip("hatchling")
    made = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(made)]
    subprocess.run(build, cwd=CHECKOUT, check=True, capture_output=True, timeout=120)
    (wheel,) = made.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(made / "site")
    return made / "site"


def test_the_wheel_holds_every_config(installed: Path) -> None:
    def files(folder: Path) -> set[str]:
        return {str(path.relative_to(folder)) for path in folder.rglob("*.yaml")}

    assert files(installed / "swamp_rl" / "configs") == files(CHECKOUT / "configs")


def test_the_wheel_holds_the_recorders_page(installed: Path) -> None:
    page = Path("swamp_rl/teleop/page")
    carried = {path.name for path in (installed / page).iterdir()}
    assert {"index.html", "style.css", "main.js"} <= carried
    assert carried == {path.name for path in (CHECKOUT / page).iterdir()}


def test_the_wheel_holds_one_package_and_the_command(installed: Path) -> None:
    (info,) = installed.glob("*.dist-info")
    assert {path.name for path in installed.iterdir()} == {"swamp_rl", info.name}
    assert (installed / "swamp_rl" / "envs" / "single.py").is_file()
    assert (installed / "swamp_rl" / "experiments" / "cli" / "app.py").is_file()
    assert "swamp-rl = swamp_rl.experiments.cli:main" in (info / "entry_points.txt").read_text()


def test_an_installed_package_finds_its_configs_by_name(installed: Path, tmp_path: Path) -> None:
    script = "from swamp_rl.files import find_config; print(find_config('boats', 'swamp'))"
    found = subprocess.run(
        [sys.executable, "-c", script],
        cwd=tmp_path,
        env={"PYTHONPATH": str(installed)},
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    assert Path(found.stdout.strip()) == installed / "swamp_rl" / "configs" / "boats" / "swamp.yaml"
