"""The environment is found by its name, and announcing it costs nothing."""

import importlib.metadata
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def output_of(program: str, cwd: Path = ROOT) -> str:
    done = subprocess.run([sys.executable, "-c", program], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.mark.parametrize("imports", ["import envs, gymnasium", "import gymnasium, envs"])
def test_the_environment_is_registered_whichever_is_imported_first(imports: str) -> None:
    entry_point = output_of(f"{imports}; print(gymnasium.spec('swamp/Gates-v0').entry_point)")
    assert entry_point == "envs.single:GatesEnv"


def test_announcing_the_environment_imports_nothing_heavy() -> None:
    heavy = "{'numpy', 'numba', 'gymnasium', 'pydantic', 'torch', 'stable_baselines3'}"
    assert output_of(f"import envs, sys; print(sorted({heavy} & set(sys.modules)))") == "[]"


def test_making_the_environment_does_not_import_torch() -> None:
    made = "import envs, sys, gymnasium; gymnasium.make('swamp/Gates-v0'); print('torch' in sys.modules)"
    assert output_of(made) == "False"


def test_once_installed_it_is_found_with_no_other_import(tmp_path: Path) -> None:
    try:
        importlib.metadata.distribution("swamp-rl")
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("the package is not installed here")
    found = "import gymnasium; print(gymnasium.spec('swamp/Gates-v0').id)"
    assert output_of(found, cwd=tmp_path) == "swamp/Gates-v0"
