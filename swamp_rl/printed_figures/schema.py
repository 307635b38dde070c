"""The schema of a figures file, strict; every fault is reported with its entry."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from swamp_rl.boat import Boat
from swamp_rl.boat.part import FROM_LIST, Part
from swamp_rl.constants import LEAST_THROTTLE
from swamp_rl.effects import LIBRARY
from swamp_rl.effects.entries import nearest_effect
from swamp_rl.errors import UserError
from swamp_rl.explain import explanations, nearest
from swamp_rl.files import read_yaml
from swamp_rl.names import is_yaml
from swamp_rl.printed_figures.manoeuvres import FIGURES, KEYS, NEEDED, OPTIONAL

Positive = Annotated[float, Field(gt=0.0, le=1e6)]
Value = Annotated[float, Field(ge=-1e9, le=1e9)]
Error = Annotated[float, Field(ge=1e-9, le=1e6)]
Text = Annotated[str, Field(min_length=1)]
Names = Annotated[tuple[str, ...], FROM_LIST]
COMMON = {"group", "manoeuvre", "mass", "figure", "value", "error", "source", "reading", "limit"}
COMMON |= {"alternative", "water_density"}
MOST = 500  # figures in a file
LEAST_ANGLE = 1.0  # deg


class Figure(Part):
    """One printed figure.

    value, error: in the figure's unit, the error one standard deviation of what the words can mean; limit:
    the value is one, and is missed only beyond it; reading: how the source's words are taken; alternative:
    another reading of a figure that is judged elsewhere in the file, shown and not judged.
    mass [kg], water_density [kg/m³]: of that test; angle_deg: of the bow azimuths, positive to starboard,
    the stern's opposed; thrusters: those that run, all of them where none is named; depth_over_draught: of
    shallow water.
    """

    group: Text
    manoeuvre: str
    mass: Positive
    figure: str
    value: Value
    error: Error
    source: Text
    reading: str = ""
    limit: Literal["at_least", "at_most"] | None = None
    alternative: bool = False
    water_density: Positive | None = None
    throttle: Annotated[float, Field(ge=LEAST_THROTTLE, le=1.0)] | None = None
    thrusters: Names = ()
    speed: Annotated[float, Field(ge=0.0, le=30.0)] | None = None
    angle_deg: Annotated[float, Field(ge=-90.0, le=90.0)] | None = None
    depth_over_draught: Annotated[float, Field(ge=1.5, le=1e6)] | None = None

    @property
    def unit(self) -> str:
        """Of value and error."""
        return FIGURES[self.manoeuvre][self.figure]

    @property
    def test(self) -> tuple[Any, ...]:
        """What the boat did: equal for figures of one test."""
        return (
            *(self.manoeuvre, self.mass, self.water_density, self.throttle, self.thrusters, self.speed),
            *(self.angle_deg, self.depth_over_draught),
        )

    @property
    def name(self) -> str:
        """The manoeuvre with its commands, and the figure."""
        parts = [self.manoeuvre]
        parts += [f"{self.angle_deg:g} deg"] if self.angle_deg is not None else []
        parts += [f"{100 * self.throttle:g} %"] if self.throttle is not None else []
        parts += ["+".join(self.thrusters)] if self.thrusters else []
        parts += [f"{self.speed:g} m/s"] if self.speed is not None else []
        parts += [f"h/T {self.depth_over_draught:g}"] if self.depth_over_draught is not None else []
        return f"{' '.join(parts)}: {self.figure.replace('_', ' ')}"


class Load(Part):
    """A load of the boat other than its file's: what the boat file would say at that mass."""

    mass: Positive
    draught: Positive
    inertia_z: Positive | None = None
    added_mass_surge: Annotated[float, Field(le=0.0)] | None = None
    added_mass_sway: Annotated[float, Field(le=0.0)] | None = None
    added_inertia_yaw: Annotated[float, Field(le=0.0)] | None = None
    source: Text


class Particular(Part):
    """Prior knowledge of an effect's parameter from a source: Gaussian, error one standard deviation."""

    effect: str
    parameter: str
    value: Value
    error: Error
    source: Text


class FiguresFile(Part):
    """A file of printed figures.

    fit: groups by stage, every stage keeping the figures of those before it;
    exchange: of a group that is fitted to, the one that takes its place for comparison.
    """

    name: Text
    description: str = ""
    loads: tuple[Load, ...] = ()
    particulars: tuple[Particular, ...] = ()
    fit: tuple[tuple[str, ...], ...]
    exchange: dict[str, str] = Field(default_factory=dict)
    figures: tuple[Figure, ...]


Numbered = list[tuple[int, Any]]
PARTS: dict[str, type[Part]] = {"loads": Load, "particulars": Particular, "figures": Figure}


def is_figures_file(path: Path) -> bool:
    """Whether `path` is a YAML file, which holds figures, and not a folder of runs."""
    return is_yaml(path)


def read_figures(path: Path, boat: Boat) -> FiguresFile:
    """The figures file at `path`, for a boat; UserError, one for each of its faults."""
    data = read_yaml(path)
    if not data.keys() & PARTS.keys():
        raise UserError(f"{path}: holds no printed figures; name a folder of runs, or a file of figures")
    faults: list[str] = []
    parts = {key: _parts(data, key, model, faults) for key, model in PARTS.items()}
    faults += [
        *_figure_faults(parts["figures"], [load.mass for _, load in parts["loads"]], boat),
        *_particular_faults(parts["particulars"]),
        *_load_faults(parts["loads"]),
    ]
    rest = {key: value for key, value in data.items() if key not in PARTS}
    sound = {key: tuple(entry for _, entry in entries) for key, entries in parts.items()}
    found = _whole(rest, sound, faults)
    if found is not None and not faults:
        exchanged = [group for pair in found.exchange.items() for group in pair]
        faults += group_faults(found, [*found.fit, exchanged])
    if found is None or faults:
        raise UserError("\n".join(f"{path}: {fault}" for fault in faults))
    return found


def _parts(data: Mapping[str, Any], key: str, model: type[Part], faults: list[str]) -> Numbered:
    """The entries of a list of the file that are sound, counted from 1; its faults are added to `faults`."""
    given = data.get(key)
    given = [] if given is None else given
    if not isinstance(given, list) or len(given) > MOST or (key == "figures" and not given):
        faults.append(
            f"{key}: must be a list of {'1 to ' if key == 'figures' else 'at most '}{MOST} mappings"
        )
        return []
    found = []
    for number, entry in enumerate(given, 1):
        if not isinstance(entry, Mapping):
            faults.append(f"{key} {number}: must be a mapping of keys to values")
            continue
        title = f" ({entry['manoeuvre']})" if "manoeuvre" in entry else ""
        try:
            found.append((number, model.model_validate(entry)))
        except ValidationError as error:
            for name, fault in explanations(error, model):
                faults.append(f"{key} {number}{title}: {name + ': ' if name else ''}{fault}")
    return found


def _whole(rest: Mapping[str, Any], sound: Mapping[str, Any], faults: list[str]) -> FiguresFile | None:
    fit = rest.get("fit")
    if not isinstance(fit, list) or not fit or not all(isinstance(stage, list) and stage for stage in fit):
        faults.append("fit: must be a list of stages, each a list of groups, such as [[bollard], [circle]]")
        return None
    try:
        return FiguresFile.model_validate({**rest, **sound, "fit": tuple(tuple(stage) for stage in fit)})
    except ValidationError as error:
        faults += [f"{name}: {fault}" for name, fault in explanations(error, FiguresFile)]
        return None


def _figure_faults(figures: Numbered, loads: Sequence[float], boat: Boat) -> list[str]:
    faults, seen = [], dict[Any, int]()
    for number, figure in figures:
        where = f"figures {number} ({figure.manoeuvre} {figure.figure})"
        faults += [f"{where}: {fault}" for fault in _faults_of(figure, loads, boat)]
        first = seen.setdefault((*figure.test, figure.figure), number)
        if first != number:
            faults.append(f"{where}: the same figure of the same test as figures {first}; keep one of them")
    return faults


def _faults_of(figure: Figure, loads: Sequence[float], boat: Boat) -> list[str]:
    """What is wrong with one figure, for that boat."""
    kind, faults = figure.manoeuvre, []
    if kind not in KEYS:
        return [f"unknown manoeuvre {kind!r}{nearest(kind, KEYS)}"]
    if figure.figure not in FIGURES[kind]:
        faults.append(f"{kind} has no such figure{nearest(figure.figure, FIGURES[kind])}")
    needed = KEYS[kind] | NEEDED.get(figure.figure, set())
    alien = sorted(figure.model_fields_set - COMMON - KEYS[kind] - OPTIONAL[kind])
    faults += [f"{key}: {kind} has no such key; drop it" for key in alien]
    faults += [f"{key} is missing; add it" for key in sorted(needed) if getattr(figure, key) is None]
    if figure.angle_deg is not None and abs(figure.angle_deg) < LEAST_ANGLE:
        faults.append(f"angle_deg: must be at least {LEAST_ANGLE:g} deg to either side")
    if figure.mass not in (*loads, boat.mass):
        known = ", ".join(f"{mass:g}" for mass in sorted({*loads, boat.mass}))
        faults.append(
            f"mass {figure.mass:g} kg is neither that of boat {boat.name} nor of one of loads ({known} kg); "
            "add a load with its draught"
        )
    faults += [
        f"thrusters: {name!r} is not a thruster of boat {boat.name}{nearest(name, boat.thruster_names)}"
        for name in figure.thrusters
        if name not in boat.thruster_names
    ]
    return faults


def _particular_faults(particulars: Numbered) -> list[str]:
    faults, seen = [], set[tuple[str, str]]()
    for number, one in particulars:
        where = f"particulars {number} ({one.effect} {one.parameter})"
        if one.effect not in LIBRARY:
            faults.append(f"{where}: unknown effect{nearest_effect(one.effect)}")
        elif one.parameter not in LIBRARY[one.effect].parameter_names:
            known = LIBRARY[one.effect].parameter_names
            faults.append(f"{where}: {one.effect} has no such parameter{nearest(one.parameter, known)}")
        if (one.effect, one.parameter) in seen:
            faults.append(f"{where}: is given twice; keep one")
        seen.add((one.effect, one.parameter))
    return faults


def _load_faults(loads: Numbered) -> list[str]:
    masses = [load.mass for _, load in loads]
    return [
        f"loads {number}: mass {load.mass:g} kg is given twice; keep one"
        for i, (number, load) in enumerate(loads)
        if load.mass in masses[:i]
    ]


def group_faults(found: FiguresFile, stages: Sequence[Sequence[str]]) -> list[str]:
    """One line for each group of the stages that no judged figure of the file belongs to."""
    judged = list(dict.fromkeys(figure.group for figure in found.figures if not figure.alternative))
    return [
        f"fit: no judged figure is of group {group!r}{nearest(group, judged)}"
        for stage in stages
        for group in stage
        if group not in judged
    ]
