"""The scripts of examples/ with their docstrings."""

import ast
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2] / "examples"


def examples() -> str:
    """A section for each script: what it shows and prints, and its source."""
    return "\n".join(_section(script) for script in sorted(FOLDER.glob("*.py")))


def _section(script: Path) -> str:
    docstring = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or ""
    source = f"```{{literalinclude}} ../examples/{script.name}\n:language: python\n```\n"
    return f"## {script.name}\n\n{docstring}\n\n{source}"
