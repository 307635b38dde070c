"""Every program of the benchmarks finds what it imports: most of them are run by hand, and rarely."""

from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MODULES = [
    ".".join(file.relative_to(ROOT).with_suffix("").parts)
    for file in sorted((ROOT / "benchmarks").rglob("*.py"))
    if file.name != "__init__.py" and not file.name.startswith("test_")
]


@pytest.mark.parametrize("module", MODULES)
def test_it_is_imported_without_running_anything(
    module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert import_module(module).__name__ == module
    assert list(tmp_path.iterdir()) == []
