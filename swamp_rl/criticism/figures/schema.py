"""What a figures file may hold, strictly; every fault is told with its entry."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from swamp_rl.boat import Boat
from swamp_rl.boat.part import FROM_LIST, Part
from swamp_rl.criticism.figures.manoeuvres import FIGURES, KEYS, OPTIONAL
from swamp_rl.effects import LIBRARY
from swamp_rl.errors import UserError
from swamp_rl.explain import explanations, nearest
from swamp_rl.files import read_yaml

Positive = Annotated[float, Field(gt=0.0)]
Text = Annotated[str, Field(min_length=1)]
Names = Annotated[tuple[str, ...], FROM_LIST]
COMMON = {"group", "manoeuvre", "mass", "figure", "value", "error", "source", "reading", "limit"}
COMMON |= {"alternative", "water_density"}
MOST = 500  # figures in a file


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
    value: float
    error: Positive
    source: Text
    reading: str = ""
    limit: Literal["at_least", "at_most"] | None = None
    alternative: bool = False
    water_density: Positive | None = None
    throttle: Annotated[float, Field(ge=0.0, le=1.0)] | None = None
    thrusters: Names = ()
    speed: Annotated[float, Field(ge=0.0, le=30.0)] | None = None
    angle_deg: Annotated[float, Field(ge=-90.0, le=90.0)] | None = None
    depth_over_draught: Annotated[float, Field(ge=1.5)] | None = None

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
    """What the sources know of a number that an effect would change: a Gaussian prior of its fit."""

    effect: str
    parameter: str
    value: float
    error: Positive
    source: Text


class FiguresFile(Part):
    """A file of printed figures. fit: groups by stage, every stage keeping the figures of those before it;
    exchange: of a group that is fitted to, the one that takes its place for comparison.
    """

    name: Text
    description: str = ""
    boat: Text | None = None
    loads: tuple[Load, ...] = ()
    particulars: tuple[Particular, ...] = ()
    fit: tuple[tuple[str, ...], ...]
    exchange: dict[str, str] = {}
    figures: tuple[Figure, ...]


PARTS = {"loads": Load, "particulars": Particular, "figures": Figure}


def is_figures_file(path: Path) -> bool:
    """Whether `path` is a YAML file, which holds figures, and not a folder of runs."""
    return path.suffix in (".yaml", ".yml")


def read_figures(path: Path, boat: Boat) -> FiguresFile:
    """The figures file at `path`, for a boat; UserError with a line for each of its faults."""
    data = read_yaml(path)
    faults: list[str] = []
    parts = {key: _parts(data, key, model, faults) for key, model in PARTS.items()}
    if not faults:
        rest = {key: value for key, value in data.items() if key not in PARTS}
        found = _whole(rest, parts, faults)
    if not faults:
        faults += [*_figure_faults(found, boat), *_particular_faults(found), *_group_faults(found)]
    if faults:
        raise UserError("\n".join(f"{path}: {fault}" for fault in faults))
    return found


def _parts(data: Mapping[str, Any], key: str, model: type[Part], faults: list[str]) -> tuple[Any, ...]:
    """The entries of a list of the file that are sound; its faults are added to `faults`."""
    given = data.get(key, [])
    if not isinstance(given, list) or (key == "figures" and not 0 < len(given) <= MOST):
        faults.append(f"{key}: must be a list of 1 to {MOST} mappings")
        return ()
    found = []
    for number, entry in enumerate(given, 1):
        try:
            found.append(model.model_validate(entry))
        except ValidationError as error:
            title = f" ({entry['manoeuvre']})" if isinstance(entry, dict) and "manoeuvre" in entry else ""
            for name, fault in explanations(error, model):
                faults.append(f"{key} {number}{title}: {name + ': ' if name else ''}{fault}")
    return tuple(found)


def _whole(rest: Mapping[str, Any], parts: Mapping[str, Any], faults: list[str]) -> FiguresFile:
    fit = rest.get("fit")
    stages = fit if isinstance(fit, list) else []
    lists = isinstance(fit, list) and all(isinstance(stage, list) for stage in stages)
    if not lists:
        faults.append("fit: must be a list of stages, each a list of groups, such as [[bollard], [circle]]")
    whole = {**rest, **parts, "fit": tuple(tuple(stage) for stage in stages) if lists else ()}
    try:
        return FiguresFile.model_validate(whole)
    except ValidationError as error:
        faults += [f"{name}: {fault}" for name, fault in explanations(error, FiguresFile)]
        return FiguresFile.model_construct()


def _figure_faults(found: FiguresFile, boat: Boat) -> list[str]:
    masses = [load.mass for load in found.loads] + [boat.mass]
    faults, seen = [], dict[Any, int]()
    for number, figure in enumerate(found.figures, 1):
        where = f"figures {number} ({figure.manoeuvre}"
        if figure.manoeuvre not in KEYS:
            faults.append(f"{where}): unknown manoeuvre{nearest(figure.manoeuvre, KEYS)}")
            continue
        where += f" {figure.figure})"
        known = FIGURES[figure.manoeuvre]
        if figure.figure not in known:
            faults.append(f"{where}: {figure.manoeuvre} has no such figure{nearest(figure.figure, known)}")
        allowed = KEYS[figure.manoeuvre] | OPTIONAL[figure.manoeuvre]
        faults += [
            f"{where}: {key}: {figure.manoeuvre} has no such key; drop it"
            for key in sorted(figure.model_fields_set - COMMON - allowed)
        ]
        faults += [
            f"{where}: {key} is missing; add it"
            for key in sorted(KEYS[figure.manoeuvre])
            if getattr(figure, key) is None
        ]
        if figure.mass not in masses:
            told = ", ".join(f"{mass:g}" for mass in sorted(set(masses)))
            faults.append(
                f"{where}: mass {figure.mass:g} kg is neither the boat's nor one of loads ({told} kg); "
                "add a load with its draught"
            )
        faults += [
            f"{where}: thrusters: {name!r} is no thruster of boat {boat.name}"
            f"{nearest(name, boat.thruster_names)}"
            for name in figure.thrusters
            if name not in boat.thruster_names
        ]
        first = seen.setdefault((*figure.test, figure.figure), number)
        if first != number:
            faults.append(f"{where}: the same figure of the same test as figures {first}; keep one of them")
    return faults


def _particular_faults(found: FiguresFile) -> list[str]:
    faults, seen = [], set[tuple[str, str]]()
    for number, one in enumerate(found.particulars, 1):
        where = f"particulars {number} ({one.effect} {one.parameter})"
        if one.effect not in LIBRARY:
            faults.append(f"{where}: unknown effect{nearest(one.effect, LIBRARY)}")
        elif one.parameter not in LIBRARY[one.effect].parameter_names:
            known = LIBRARY[one.effect].parameter_names
            faults.append(f"{where}: {one.effect} has no such parameter{nearest(one.parameter, known)}")
        if (one.effect, one.parameter) in seen:
            faults.append(f"{where}: is given twice; keep one")
        seen.add((one.effect, one.parameter))
    masses = [load.mass for load in found.loads]
    return faults + [
        f"loads {number}: mass {mass:g} kg is given twice; keep one"
        for number, mass in enumerate(masses, 1)
        if mass in masses[: number - 1]
    ]


def _group_faults(found: FiguresFile) -> list[str]:
    exchanged = [group for pair in found.exchange.items() for group in pair]
    return group_faults(found, [*found.fit, exchanged])


def group_faults(found: FiguresFile, stages: Sequence[Sequence[str]]) -> list[str]:
    """One line for each group of the stages that no judged figure of the file belongs to."""
    judged = list(dict.fromkeys(figure.group for figure in found.figures if not figure.alternative))
    return [
        f"fit: no judged figure is of group {group!r}{nearest(group, judged)}"
        for stage in stages
        for group in stage
        if group not in judged
    ]
