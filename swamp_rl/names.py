"""Names of files that come from a file of someone else: each confined to the folder that it was read in."""

from collections import defaultdict
from collections.abc import Collection, Sequence
from pathlib import Path

from swamp_rl.clipped import clipped
from swamp_rl.errors import UserError

LONGEST = 200
"Bytes of a name, with room for what is put before it while the file is written; a file system takes 255."
YAML = (".yaml", ".yml")


def is_yaml(name: str | Path) -> bool:
    """Whether a name or path is that of a YAML file, whatever the case of its letters."""
    return str(name).lower().endswith(YAML)


def plain_name(name: str, suffixes: Collection[str] = ("",)) -> str:
    """The name, if it can only be that of a file in a folder; else ValueError with what is allowed.

    It ends in one of `suffixes`, whatever the case of its letters, has no separator, does not begin with a
    point and prints on one line. It is not looked for.
    """
    reason = None
    if not name or "/" in name or "\\" in name or name.startswith(".") or not name.isprintable():
        reason = "must be a plain name: no folder, no point at its beginning, nothing that does not print"
    elif len(name.encode("utf-8", "surrogatepass")) > LONGEST:
        reason = f"is too long, a name has at most {LONGEST} bytes"
    elif not any(name.lower().endswith(suffix) for suffix in suffixes):
        reason = f"must end in {' or '.join(suffixes)}"
    if reason is not None:
        raise ValueError(f"{name[:60]!r} {reason}")
    return name


def free_name(name: str, taken: Collection[str]) -> str:
    """The name, or with a number before its suffix where it is taken: `boat-2.yaml`."""
    path, number, free = Path(name), 1, name
    while free in taken:
        number += 1
        free = path.with_name(f"{path.stem}-{number}{path.suffix}").as_posix()
    return free


def told_apart(folders: Collection[Path]) -> dict[Path, tuple[str, ...]]:
    """The last parts of each folder's path, one or as many as tell it from the others, whatever the case.

    Paths that only the case tells apart have one part.
    """
    depth = dict.fromkeys(folders, 1)
    while True:
        labels = {folder: folder.parts[1:][-count:] for folder, count in depth.items()}
        share = defaultdict[tuple[str, ...], set[tuple[str, ...]]](set)
        for folder, label in labels.items():
            share[_lower(label)].add(_lower(folder.parts[1:]))
        alike = [folder for folder, label in labels.items() if len(share[_lower(label)]) > 1]
        if not alike:
            return labels
        for folder in alike:
            depth[folder] += 1


def _lower(label: Sequence[str]) -> tuple[str, ...]:
    return tuple(part.lower() for part in label)


def refuse_odd_label(
    where: Path | str, name: str, of: str = "pilot or a level", advice: str = "run the experiment again"
) -> None:
    """UserError for a name, read or found at `where`, on which a table or a terminal would act."""
    if not name or not name.isprintable() or len(name) > LONGEST or set(name) & set("[]|<>`*"):
        raise UserError(f"{where}: {clipped(name)!r} is not a name of a {of}; {advice}")


def file_in(folder: Path, name: str, suffixes: Collection[str]) -> Path:
    """The path of the file `name` in `folder`, whether it is there or not.

    UserError unless it is a `plain_name`, and where a link of that name leads elsewhere.
    """
    try:
        path = folder / plain_name(name, suffixes)
    except ValueError as error:
        raise UserError(f"{folder}: {error}") from error
    refuse_link(path)
    return path


def refuse_link(path: Path) -> None:
    """UserError where a path in a folder of someone else is a link, which may lead to any file."""
    if path.is_symlink():
        raise UserError(f"{path}: is a link; put a copy of the file in its place")
