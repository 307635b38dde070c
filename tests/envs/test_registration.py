"""The environment is found by its name, and announcing it costs nothing."""

import subprocess
import sys
from pathlib import Path

import gymnasium
import pytest

import swamp_rl  # noqa: F401  registers the environments

ROOT = Path(__file__).parents[2]


def output_of(program: str, cwd: Path = ROOT) -> str:
    done = subprocess.run([sys.executable, "-c", program], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.mark.parametrize("imports", ["import swamp_rl, gymnasium", "import gymnasium, swamp_rl"])
def test_the_environment_is_registered_whichever_is_imported_first(imports: str) -> None:
    entry_point = output_of(f"{imports}; print(gymnasium.spec('swamp/Gates-v1').entry_point)")
    assert entry_point == "swamp_rl.envs.single:GatesEnv"


def test_announcing_the_environment_imports_nothing_heavy() -> None:
    heavy = "{'numba', 'pydantic', 'torch', 'stable_baselines3', 'scipy', 'matplotlib'}"
    assert output_of(f"import swamp_rl, sys; print(sorted({heavy} & set(sys.modules)))") == "[]"


def test_making_the_environment_does_not_import_torch() -> None:
    made = "import swamp_rl, sys, gymnasium; gymnasium.make('swamp/Gates-v1'); print('torch' in sys.modules)"
    assert output_of(made) == "False"


def test_gymnasium_imports_the_package_that_an_environments_name_begins_with(tmp_path: Path) -> None:
    program = "import gymnasium; print(gymnasium.make('swamp_rl:swamp/Gates-v1').spec.id)"
    assert output_of(program, cwd=tmp_path) == "swamp/Gates-v1"


@pytest.mark.filterwarnings("ignore:.*Gates-v0")
def test_the_first_version_keeps_the_boat_that_the_thesis_printed() -> None:
    made = [gymnasium.make(f"swamp/Gates-v{version}").unwrapped for version in (0, 1)]
    assert [env.fleet.boat.name for env in made] == ["swamp-thesis", "swamp"]  # type: ignore[attr-defined]
