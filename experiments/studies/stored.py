"""Evaluate pilots that are trained already: those of an experiment's folder, or any that are stored."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, NoReturn

from swamp_rl.experiments.artifacts.provenance import (
    CONFIG,
    EXPERIMENT,
    TRAINED,
    TRUE_BOAT,
    home_of,
    kept_config,
    same_configs,
)
from swamp_rl.experiments.artifacts.stages import say
from swamp_rl.experiments.config.load import load_experiment, overridden, unchecked
from swamp_rl.experiments.config.schema import Experiment, Targets, pilot_name
from swamp_rl.experiments.studies.run import evaluated

from swamp_rl.clipped import printable
from swamp_rl.errors import UserError
from swamp_rl.files import shipped_folders, written_path
from swamp_rl.pilots.arguments import Asked, asked_pilot
from swamp_rl.pilots.store import DESCRIPTION, load_pilot

CHANGEABLE = ("evaluation", "targets")
"""What may differ from the experiment that the pilots were trained in."""
OF_TRAINING = ("pilots", "targets", "hidden", "claims")
"""What does not matter to the experiment in whose boat, course and levels other pilots are evaluated."""
USUAL = "camogli"
"""The experiment of the boat and the course that the environment has where nothing else is asked of it."""


def evaluate_folders(
    sources: Sequence[Path | str] | Path | str,
    changes: Mapping[str, Any] = MappingProxyType({}),
    overrides: Iterable[str] = (),
    out: Path | str | None = None,
    experiment: str | None = None,
) -> Path:
    """Evaluate pilots in the same episodes; write and return a folder of results.

    - `sources`: the folder of a trained experiment, whose pilots are evaluated; or several such folders,
      folders of stored pilots and other pilots (see `asked_pilot`), which are evaluated together.
    - `changes`: keys of `evaluation`, such as `episodes`, `levels` and `seed`.
    - `overrides`: dotted keys as `key=value`.
    - `out`: the folder to write; by default the only source folder itself, or results/evaluation.
    - `experiment`: gives boat, course, data and evaluation; by default that of the first folder with an
      experiment, or `camogli`, with a note, if no folder is named.

    UserError if a folder holds no pilot, if no experiment is given and no named folder has one, or if
    `overrides` would need training.
    """
    asked_for = list(sources) if isinstance(sources, list | tuple) else [sources]
    for one in asked_for:
        if not isinstance(one, str | Path):
            raise UserError(
                f"evaluate: an object of the type {type(one).__name__} was given; name a folder of pilots, "
                "or save the model and name its file: sb3:MODEL.zip"
            )
    pilots = _once([asked_pilot(str(one)) for one in asked_for])
    if not pilots:
        raise UserError("no folder to evaluate; name one of results, or of a stored pilot")
    out = None if out is None else written_path(out)
    folders = [pilot.folder for pilot in pilots if pilot.folder is not None]
    for folder in folders:
        if not folder.is_dir():
            raise UserError(f"{folder}: no such folder; name one of results, or of a stored pilot")
    asked = {"evaluation": dict(changes)}
    home = home_of(folders[0]) if folders else None
    if len(pilots) == 1 and experiment is None and home is not None and not _is_pilot(folders[0]):
        return _of_results(home, asked, overrides, out)
    return _of_pilots(pilots, experiment, asked, overrides, out or Path("results") / "evaluation")


def _once(pilots: Sequence[Asked]) -> list[Asked]:
    """The pilots, each once, as a folder is named again for each code that its pilots need."""
    named = {(one.kind, one.place.resolve() if one.place else None): one for one in pilots}
    return list(named.values())


def _of_results(home: Path, asked: Mapping[str, Any], overrides: Iterable[str], out: Path | None) -> Path:
    """The pilots in the folder; its own place gets the results where nothing else is asked of them."""
    with same_configs(home / CONFIG):
        kept = load_experiment(home)
        experiment = overridden(home, kept, asked, overrides)
        there = [name for name in kept.pilots if _is_pilot(home / "pilots" / name)]
        if not there:
            _refuse_none(home, "train them with swamp-rl train")
        fixed = set(Experiment.model_fields) - set(CHANGEABLE)
        if any(getattr(experiment, key) != getattr(kept, key) for key in fixed):
            raise UserError(
                f"{home}: only {' and '.join(CHANGEABLE)} can be set, nothing is trained again; to drive "
                f"another boat or course, name the pilots: {home / 'pilots' / there[0]}"
            )
        for name in there:
            load_pilot(home / "pilots" / name)  # a damaged one is refused now, and not from a copy
        same = experiment == kept and ((home / TRAINED).is_file() or len(there) == len(kept.pilots))
        place = out or (home if same else home.with_name(f"{home.name}-evaluation"))
        return evaluated(restricted(experiment, there), home, place, home)


def _of_pilots(
    pilots: Sequence[Asked],
    name: str | None,
    asked: Mapping[str, Any],
    overrides: Iterable[str],
    out: Path,
) -> Path:
    """All pilots, those of folders as kind `stored`, in the scene of one experiment."""
    plans = _plans_of(pilots)
    folders = [pilot.folder for pilot in pilots if pilot.folder is not None]
    homes = [home for folder in folders if (home := home_of(folder)) is not None]
    if name is None and not homes:
        name = _usual(folders)
    config = homes[0] / CONFIG if name is None else kept_config(name)
    home = config.parent if config is not None and config.name == CONFIG else None
    with same_configs(config):
        settings: dict[str, Any] = {"name": "evaluation", "description": "", "pilots": plans, **asked}
        if home is not None and (home / "data").is_dir():
            settings["data"] = {"folder": str((home / "data").resolve()), "sha256": None}
        given, over = homes[0] if name is None else name, ("evaluate", settings)
        experiment = load_experiment(given, overrides, over=over, unread=OF_TRAINING)
        _note_hidden(given, experiment)
        return evaluated(experiment, "evaluate", out, None)


def _note_hidden(given: Path | str, experiment: Experiment) -> None:
    """Say that the effects of a closed loop's true boat do not act, where its boat file is driven."""
    named = unchecked(given)
    if named.get("hidden") and named.get("boat") == experiment.boat:
        file = Path(given) / TRUE_BOAT
        true = file if file.is_file() else "FILE, a boat file with these effects"
        say(
            f"{given}: its hidden effects do not act, the pilots drive boat {experiment.boat}; for the true "
            f"boat --set boat={true}"
        )


def _usual(folders: Sequence[Path]) -> str:
    """The experiment where none is given; UserError for folders of pilots of which it is not known."""
    for folder in folders:
        if folder not in shipped_folders("pilots").values():
            raise UserError(
                f"{folder}: it has no {CONFIG}/{EXPERIMENT} with a boat, a course and levels; name an "
                f"experiment with --experiment, such as {USUAL}"
            )
    say(f"boat, course and levels are those of the experiment {USUAL}; --experiment names another")
    return USUAL


def _plans_of(pilots: Sequence[Asked]) -> dict[str, Mapping[str, Any]]:
    """Plans by the name they are reported under: the pilot's, with that of what holds it where two agree."""
    found: list[tuple[str, str, str, Mapping[str, Any]]] = []  # name, that of what holds it, where, plan
    for pilot in pilots:
        if pilot.folder is None:
            beside = pilot.place.resolve().parent if pilot.place else Path.cwd()
            holder = pilot.kind.partition(":")[0] if beside == Path.cwd() else beside.name
            where = str(pilot.place or pilot.kind)
            found.append((pilot.name, holder, where, {"kind": pilot.kind, "options": pilot.options}))
            continue
        for folder in _stored_in(pilot.folder):
            holder = (home_of(folder) or _holder(folder.resolve())).name
            stored = {"kind": "stored", "options": {"folder": str(folder)}}
            found.append((folder.resolve().name, holder, str(folder), stored))
    names = [pilot_name(name) for name, *_ in found]
    plans: dict[str, Mapping[str, Any]] = {}
    for name, (own, holder, where, plan) in zip(names, found, strict=True):
        called = name if names.count(name) == 1 else pilot_name(f"{holder}-{own}")
        if called in plans:
            raise UserError(f"{where}: another pilot is called {called} as well; rename one file or folder")
        plans[called] = plan
    return plans


def _holder(pilot: Path) -> Path:
    """The folder that holds a pilot's, without the `pilots` that every training has."""
    return pilot.parent.parent if pilot.parent.name == "pilots" else pilot.parent


def _refuse_none(folder: Path, advice: str) -> NoReturn:
    """UserError that a folder holds no trained pilot, with the folders in it that do, as of `hidden`."""
    below = sorted({str(file.parents[2]) for file in folder.glob(f"*/pilots/*/{DESCRIPTION}")})
    if below:
        advice = (
            f"name {' or '.join(printable(one) for one in below)}, with --experiment {printable(str(folder))}"
        )
        if (folder / TRUE_BOAT).is_file():
            advice += f" --set boat={printable(str(folder / TRUE_BOAT))}"
    raise UserError(f"{folder}: holds no trained pilot{' itself' if below else ''}; {advice}")


def _stored_in(folder: Path) -> list[Path]:
    """The folder of a stored pilot, or those of the pilots of a folder of results."""
    inside = [file.parent for file in sorted(folder.glob(f"pilots/*/{DESCRIPTION}"))]
    if not _is_pilot(folder) and not inside:
        _refuse_none(folder, "name a folder of results or of a stored pilot")
    return [folder] if _is_pilot(folder) else inside


def _is_pilot(folder: Path) -> bool:
    return (folder / DESCRIPTION).is_file()


def restricted(experiment: Experiment, names: Sequence[str]) -> Experiment:
    """The experiment with some of its pilots only, and the targets that name these."""
    targets = experiment.targets
    success = {name: levels for name, levels in targets.success.items() if name in names}
    smooth = tuple(name for name in targets.smoother_than_data if name in names)
    return experiment.model_copy(
        update={
            "pilots": {name: experiment.pilots[name] for name in names},
            "targets": Targets(success=success, smoother_than_data=smooth),
        }
    )
