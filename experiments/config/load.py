"""Experiment files read strictly, with `extends:` and with overrides by dotted key."""

import os
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import accumulate
from pathlib import Path
from typing import Any

import yaml
from swamp_rl.envs.own_terms import own_term
from swamp_rl.envs.reward import weights_of
from swamp_rl.experiments.config.layers import Layer, merged, with_targets_evaluated
from swamp_rl.experiments.config.learners import check_logged, check_recorded, in_order, learner
from swamp_rl.experiments.config.named_files import refuse_missing
from swamp_rl.experiments.config.schema import Experiment, PilotPlan, senses_in
from swamp_rl.experiments.config.smoke import shrunk

from swamp_rl import own_code
from swamp_rl.clipped import clipped
from swamp_rl.config_kind import refuse_other_kind
from swamp_rl.errors import UserError, errors_at
from swamp_rl.explain import in_yaml
from swamp_rl.files import config_beside, find_config, is_file, or_beside, read_yaml, validated
from swamp_rl.names import is_yaml
from swamp_rl.own_code import is_code
from swamp_rl.pilots.own import is_named, runs_code
from swamp_rl.yaml_text import DEEPEST, parsed

KEPT = "experiment.yaml"
"The name of the configuration that a folder of results keeps."
SOMEWHERE = "<layer>"
"At the beginning of a fault whose layer is yet to be found."


def load_experiment(
    name_or_path: str | Path,
    overrides: Iterable[str] = (),
    given: Mapping[str, str] | None = None,
    over: Layer | None = None,
    unread: Collection[str] = (),
) -> Experiment:
    """The experiment of a file, given by path, by its bare name in configs/experiments or by its results.

    An `extends:` in the file names another whose keys it overrides; `overrides` (or one, as a text) are
    `key=value` with a dotted key and a YAML value, and come last. A file or overrides that give other levels
    remove the targets of the files below at levels that are no longer evaluated. UserError names the file, or
    the override, and the key of the first fault. given: where an override comes from, by its text; by
    default `override TEXT`. over: a layer between the files and the overrides. unread: keys of the files that
    are left out, whatever they hold.
    """
    path, named = _file_of(name_or_path), _named(overrides, given or {})
    allowed = {text for _, override in named for text in _texts(override)}
    layers = [
        (file, {key: value for key, value in data.items() if key not in unread})
        for file, data in _extended(path, ())
    ]
    for file, data in layers:
        if file.name == KEPT:
            _refuse_code(file, data, allowed)
    above = [*([] if over is None else [over]), *named]
    return _read(with_targets_evaluated([*([layer] for layer in layers), above]))


def unchecked(name_or_path: str | Path) -> dict[str, Any]:
    """What the files of an experiment hold together, whether or not it is sound."""
    whole: dict[str, Any] = {}
    for _, data in _extended(_file_of(name_or_path), ()):
        whole = merged(whole, data)
    return whole


def overridden(
    where: str | Path, experiment: Experiment, changes: Mapping[str, Any], overrides: Iterable[str] = ()
) -> Experiment:
    """The experiment with `changes` by key over it, then `overrides`; UserError names `where`, or the
    override at fault, and the key."""
    below, above = [(where, experiment.model_dump(mode="json"))], [(where, dict(changes))]
    return _read(with_targets_evaluated([below, [*above, *_named(overrides, {})]]))


def _read(layers: Sequence[Layer]) -> Experiment:
    """The experiment of all layers; UserError names, for each fault, the layer from which on it is there."""
    stages = list(accumulate((data for _, data in layers), merged))
    try:
        return _checked(SOMEWHERE, stages[-1])
    except UserError as error:
        faults = str(error).splitlines()
    found = [_faults(stage) for stage in stages]
    named = (fault.replace(SOMEWHERE, str(_origin(fault, layers, found)), 1) for fault in faults)
    raise UserError("\n".join(named))


def _faults(data: dict[str, Any]) -> list[str]:
    """The faults of an experiment, one a line, with `SOMEWHERE` in place of their layer."""
    try:
        _checked(SOMEWHERE, data)
    except UserError as error:
        return str(error).splitlines()
    return []


def _origin(fault: str, layers: Sequence[Layer], found: Sequence[Sequence[str]]) -> str | Path:
    """The lowest layer from which on all have the fault; found: the faults of each stage."""
    origin = layers[-1][0]
    for (where, _), faults in zip(layers[::-1], found[::-1], strict=True):
        if fault not in faults:
            break
        origin = where
    return origin


def _checked(where: str | Path, data: dict[str, Any]) -> Experiment:
    return _with_all_options(where, validated(where, Experiment, data))


def _file_of(name_or_path: str | Path) -> Path:
    """The file meant; a folder of results means the one in its `config`, where there is one."""
    given = Path(name_or_path)
    for file in (given / "config" / KEPT, given / KEPT):
        if is_file(file):
            return file
    try:
        return find_config("experiments", name_or_path)
    except UserError as error:
        if os.path.isdir(given):
            raise UserError(
                f"{given}: no config/experiment.yaml in this folder; name one of results, or an experiment"
            ) from error
        raise


def _with_all_options(path: str | Path, experiment: Experiment) -> Experiment:
    """The experiment with every option of its pilots written out.

    UserError for an unknown or wrong one, and for a boat, course or level that is not there.
    """
    refuse_missing(path, experiment)
    pilots = {}
    for name, plan in experiment.pilots.items():
        _check_keys_of_kind(f"{path}: pilots.{name}", plan)
        below = "pilots", name, "options"
        settings = validated(path, learner(plan.kind).settings, plan.options, below)
        pilots[name] = plan.model_copy(update={"options": settings.model_dump(mode="json")})
        if experiment.data.folder is None:
            check_logged(f"{path}: pilots.{name}.options", pilots[name])
            with errors_at(f"{path}: pilots.{name}.options"):
                check_recorded(pilots[name], experiment.data.record)
    try:
        in_order(pilots)
        weights = weights_of(experiment.reward)
        for name in filter(is_code, weights):
            own_term("reward", name)
    except UserError as error:
        raise UserError(f"{path}: {error}") from error
    whole = experiment.model_copy(update={"pilots": pilots, "reward": weights})
    return shrunk(whole) if experiment.smoke else whole


def _check_keys_of_kind(where: str, plan: PilotPlan) -> None:
    """UserError where the kind is unknown, or where a key has no meaning for it."""
    try:
        learns = learner(plan.kind)
    except UserError as error:
        raise UserError(f"{where}.kind: {error}") from error
    if plan.runs is not None and not learns.from_runs:
        raise UserError(f"{where}.runs: {plan.kind} does not learn from runs; drop the key")
    if plan.skill is not None and not learns.from_runs:
        raise UserError(f"{where}.skill: {plan.kind} does not learn from runs; drop the key")
    if plan.outcomes != ("success",) and not learns.from_runs:
        raise UserError(f"{where}.outcomes: {plan.kind} does not learn from runs; drop the key")
    if plan.disturbances is not None and not learns.by_trying:
        raise UserError(f"{where}.disturbances: {plan.kind} does not train among them; drop the key")
    if plan.takeover > 0.0 and plan.kind == "scripted":
        raise UserError(f"{where}.takeover: it would take over from itself; drop the key")


def _extended(path: Path, seen: tuple[Path, ...]) -> list[tuple[Path, dict[str, Any]]]:
    """The layers of the file at `path`: those of the experiment that it extends, then its own."""
    if path.resolve() in seen:
        raise UserError(f"{path}: extends itself by way of {seen[-1].name}; end the circle")
    data = read_yaml(path)
    refuse_other_kind(path, data, "experiment")
    if path.name != KEPT:
        _find_beside(path, data)
    base = data.pop("extends", None)
    if base is None:
        return [(path, data)]
    if not isinstance(base, str):
        raise UserError(f"{path}: extends must name another experiment, not {in_yaml(base)}")
    return [*_extended(_base_of(path, base), (*seen, path.resolve())), (path, data)]


def _base_of(path: Path, base: str) -> Path:
    """The experiment that the one at `path` extends: a file beside it, or as `find_config` finds it."""
    beside = path.parent / base
    if is_yaml(beside) and beside.is_file():
        return beside
    with errors_at(f"{path}: extends"):
        return find_config("experiments", base)


def _find_beside(path: Path, data: dict[str, Any]) -> None:
    """Replace the paths in `data`, read from `path`, that exist only from its folder."""
    logged, evaluation, pilots, hidden = (
        _mapping(data.get(key)) for key in ("data", "evaluation", "pilots", "hidden")
    )
    if isinstance(logged.get("folder"), str):
        logged["folder"] = or_beside(path, logged["folder"])
    recorded = (_mapping(logged.get("record")), _mapping(hidden.get("logs")))
    for holder in (data, *recorded, *map(_mapping, pilots.values())):
        for key in ("boat", "course", "disturbances"):
            if isinstance(holder.get(key), str):
                holder[key] = config_beside(path, holder[key])
    if isinstance(levels := evaluation.get("levels"), list):
        evaluation["levels"] = [config_beside(path, one) if isinstance(one, str) else one for one in levels]


def _mapping(data: Any) -> dict[str, Any]:
    return data if isinstance(data, dict) else {}


def _texts(data: Any) -> Iterator[str]:
    """Every text in what was parsed, keys included."""
    if isinstance(data, Mapping):
        for key, value in data.items():
            yield from (*_texts(key), *_texts(value))
    elif isinstance(data, list | tuple):
        for item in data:
            yield from _texts(item)
    elif isinstance(data, str):
        yield data


def _refuse_code(path: Path, data: dict[str, Any], allowed: Collection[str]) -> None:
    """UserError where a folder of results asks for code that its reader has not named."""
    pilots = data.get("pilots")
    for name, plan in pilots.items() if isinstance(pilots, Mapping) else ():
        kind = plan.get("kind") if isinstance(plan, Mapping) else None
        if isinstance(kind, str) and runs_code(kind) and kind not in allowed and not is_named(kind):
            argument = f"{kind}=FOLDER" if is_code(kind) else "sb3:MODEL.zip"
            raise UserError(
                f"{path}: pilots.{name}.kind: {kind} runs code, which a folder of results may not ask for; "
                f"if it is yours, name it: run with the override pilots.{name}.kind={kind} (--set), evaluate "
                f"with {argument}"
            )
    reward = data.get("reward")
    terms = [("reward", term) for term in (reward if isinstance(reward, Mapping) else ())]
    terms += [("pilots", term) for senses in senses_in(pilots) for term in senses]
    for where, term in terms:
        if is_code(term) and term not in allowed and not own_code.is_named(term):
            raise UserError(
                f"{path}: {where}: {term} is code, which a folder of results may not ask for; if it is "
                f"yours, name it: run with the override 'reward={{{term}: WEIGHT}}' or "
                f"'pilots.NAME.options.senses=[{term}, ...]' (--set), evaluate with {term}=FOLDER"
            )


def _named(overrides: Iterable[str], given: Mapping[str, str]) -> list[Layer]:
    texts = [overrides] if isinstance(overrides, str) else overrides
    named = [(clipped(given[text]) if text in given else f"override {clipped(text)}", text) for text in texts]
    return [(name, _parsed(name, text)) for name, text in named]


def _parsed(message: str, override: str) -> dict[str, Any]:
    key, equals, text = override.partition("=")
    parts = key.split(".")
    if not equals or not all(parts) or len(parts) > DEEPEST:
        raise UserError(f"{message}: must be key=value, with a dotted key such as evaluation.episodes=100")
    try:
        value = parsed(text)
    except (yaml.YAMLError, ValueError) as error:
        problem = " ".join(str(getattr(error, "problem", None) or error).split())
        raise UserError(f"{message}: the value is malformed YAML ({problem}); put it in quotes") from error
    for part in reversed(parts):
        value = {part: value}
    return value
