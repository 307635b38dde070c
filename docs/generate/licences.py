"""Licences of the packages that this one uses, from what their own metadata say."""

import re
import tomllib
from importlib.metadata import PackageMetadata, PackageNotFoundError, metadata
from pathlib import Path

from docs.generate.markdown import table

PROJECT = Path(__file__).parents[2] / "pyproject.toml"
OWN = "swamp-rl"


def licences() -> str:
    """A table of the direct dependencies, the extras that need them, and their licences."""
    rows = [
        [f"`{name}`", ", ".join(f"`{extra}`" for extra in extras), licence(name)]
        for name, extras in sorted(dependencies().items())
    ]
    return table(["package", "extra", "licence"], rows)


def dependencies() -> dict[str, list[str]]:
    """The packages that pyproject.toml names, and the extras that need each, none for those of every use."""
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    parts = {"": project["dependencies"], **project["optional-dependencies"]}
    found: dict[str, list[str]] = {}
    for extra, named in parts.items():
        for requirement in named:
            name = re.split(r"[^\w.-]", requirement, maxsplit=1)[0]
            if name != OWN:
                found.setdefault(name, []).extend([extra] * bool(extra))
    return found


def licence(name: str) -> str:
    """Of an installed package; that it is not installed where this is so."""
    try:
        fields = metadata(name)
    except PackageNotFoundError:
        return "not installed where this page was made"
    return (
        fields.get("License-Expression") or _classified(fields) or str(fields.get("License")).split("\n")[0]
    )


def _classified(fields: PackageMetadata) -> str:
    """The licences among the classifiers."""
    known = [text.split(" :: ") for text in fields.get_all("Classifier") or []]
    return ", ".join(parts[-1] for parts in known if parts[0] == "License")
