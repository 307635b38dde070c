"""`swamp-rl effects`, `boats`, `courses` and `pilots`: what there is, all of it or one by its name."""

import json
from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any

import typer

from swamp_rl.errors import UserError

if TYPE_CHECKING:
    from pydantic import BaseModel

    from swamp_rl.effects import Effect, Parameter

COMBINED = {"add": "add up", "multiply": "multiply", "replace": "replace one another"}
LIMITS = {  # of an option, as annotated-types names them
    "ge": "at least",
    "gt": "above",
    "le": "at most",
    "lt": "below",
    "min_length": "entries at least",
    "max_length": "entries at most",
}


def effects(
    name: Annotated[str | None, typer.Argument(help="An effect; by default all.")] = None,
) -> None:
    """List the effects with their parameters, units, bounds and sources."""
    from swamp_rl.effects import LIBRARY
    from swamp_rl.effects.entries import nearest_effect

    if name is not None and name not in LIBRARY:
        raise UserError(f"no effect {name!r}{nearest_effect(name)}")
    for effect in LIBRARY.values() if name is None else [LIBRARY[name]]:
        typer.echo("\n".join(_effect_lines(effect)))


def boats(
    name: Annotated[str | None, typer.Argument(help="A name in configs/boats, or a boat file.")] = None,
) -> None:
    """List the boats; of one, every number with its unit, provenance and source."""
    from swamp_rl.boat import load_boat
    from swamp_rl.boat.quantity import value_at
    from swamp_rl.files import config_names

    if name is None:
        for known in config_names("boats"):
            boat = load_boat(known)
            typer.echo(
                f"{known:<14} {boat.length:g} m long, {boat.breadth:g} m wide, {boat.mass:g} kg, "
                f"thrusters {', '.join(boat.thruster_names)}"
            )
        return
    boat = load_boat(name)
    for key, origin in boat.provenance.items():
        value = _number(value_at(boat, key.split(".")))
        typer.echo(f"{key} = {value} [{origin.unit}], {origin.provenance}: {origin.source}")
    for entry in boat.effects:
        on = f" {entry.thruster}" if entry.thruster else ""
        given = [f"{p.name} {entry.values[p.name]:g} {p.unit}" for p in entry.effect.parameters]
        given += (
            [f"{key} {value}" for key, value in entry.curve.mapping(entry.values).items()]
            if entry.curve
            else []
        )
        typer.echo(f"effect {entry.effect.name}{on}: {', '.join(given)}")


def courses(
    name: Annotated[str | None, typer.Argument(help="A name in configs/courses, or a course file.")] = None,
) -> None:
    """List the courses with their gates, start and bounds (m, deg, s)."""
    from math import degrees

    from swamp_rl.course import load_course
    from swamp_rl.files import config_names

    for known in config_names("courses") if name is None else [name]:
        course = load_course(known)
        pose, edge = course.start.pose, course.bounds
        typer.echo(f"{course.name}: {len(course.gates)} gates, time limit {round(course.time_limit, 1):g} s")
        if course.boat_length is not None:
            typer.echo(f"  for a boat of {course.boat_length:g} m; for others scaled by their length")
        for gate in course.gates:
            at = f"north {_metres(gate.centre.north)}, east {_metres(gate.centre.east)} m"
            towards = f"passed towards {round(degrees(gate.heading), 1):g} deg"
            typer.echo(f"  gate {gate.name}: {at}, width {_metres(gate.width)} m, {towards}")
        at, heading = f"north {_metres(pose.north)}, east {_metres(pose.east)} m", degrees(pose.heading)
        south, north, west, east = map(_metres, (edge.south, edge.north, edge.west, edge.east))
        typer.echo(f"  start: {at}, {round(heading, 1):g} deg")
        typer.echo(f"  bounds: north {south} to {north}, east {west} to {east} m")
        if course.depth is not None:
            typer.echo(
                "  depth: " + " to ".join(f"{depth:g}" for depth in sorted({*course.depth.uniform})) + " m"
            )


def _metres(length: float) -> str:
    """To the centimetre."""
    return f"{round(length, 2):z.10g}"


def pilots(
    name: Annotated[str | None, typer.Argument(help="A kind of pilot, as in an experiment's YAML.")] = None,
) -> None:
    """List the kinds of pilots; of one, its options with their defaults and bounds."""
    from swamp_rl.experiments.config.learners import LEARNERS, learner

    from swamp_rl.pilots.own import SHIPPED, own_kinds

    _refuse_unknown("kind of pilot", name, [*LEARNERS, *own_kinds()])
    if name is None:
        for kind in LEARNERS:
            one = learner(kind)
            sources = ("recorded runs",) * one.from_runs + ("the simulator",) * one.by_trying
            typer.echo(
                f"{kind:<19} {'learns from ' + ' and '.join(sources) if sources else 'is not trained'}"
                + "".join(f"; {text}" for text in _shipped(kind))
            )
        for kind in own_kinds():
            typer.echo(
                f"{kind:<19} {'is read from a file' if kind in SHIPPED else 'of an installed package'}"
            )
        return
    for line in _option_lines(learner(name).settings):
        typer.echo(line)


def _shipped(kind: str) -> list[str]:
    """The trained pilots of a kind that come with the package, by the name that demo and evaluate take."""
    from swamp_rl.files import shipped_folders
    from swamp_rl.pilots.store import describe_pilot

    lines = []
    for name, folder in shipped_folders("pilots").items():
        description = describe_pilot(folder)
        if description.kind == kind:
            fitted = (
                f", trained on {len(description.fitted_on.runs)} {description.fitted_on.source} runs"
                if description.fitted_on
                else ""
            )
            made = (
                f", by {description.made.package} for the boat {description.made.boat}"
                if description.made
                else ""
            )
            lines.append(f"shipped as {name}{fitted}{made}")
    return lines


def _refuse_unknown(what: str, name: str | None, known: Iterable[str]) -> None:
    from swamp_rl.explain import nearest

    if name is not None and name not in (known := list(known)):
        raise UserError(f"no {what} {name!r}{nearest(name, known)}")


def _effect_lines(effect: "Effect") -> list[str]:
    if effect.curve:
        key = ["  component, covariate, knots, values, and, where known, standard_errors"]
        key += ["  formula: a formula on the interval between two knots, in place of values"]
        key += ["  thruster: a name, of a thrust, an azimuth or a throttle"]
    else:
        key = ["  thruster: two names"] if effect.swaps else ["  thruster: a name, or all"] * effect.thruster
    return [
        f"{effect.name}: {effect.description}",
        f"  acts on: {effect.acts_on}; several entries {COMBINED[effect.combine]}; source: {effect.source}",
        f"  {_searched(effect)}",
        *key,
        *(f"  {parameter.name}: {_parameter(parameter)}" for parameter in effect.parameters),
    ]


def _searched(effect: "Effect") -> str:
    if effect.begin is None:
        return "never a cause in a diagnosis"
    place = (
        "the same in every run"
        if effect.scope == "boat"
        else f"may differ from {effect.scope} to {effect.scope}"
    )
    return place + ("; a nuisance in a diagnosis" if effect.nuisance else "")


def _parameter(parameter: "Parameter") -> str:
    neutral = "the boat file's" if parameter.neutral is None else f"{parameter.neutral:g}"
    return f"{parameter.allowed}; neutral: {neutral}" + ("; must be given" if parameter.required else "")


def _option_lines(settings: "type[BaseModel]") -> list[str]:
    lines = []
    for key, field in settings.model_fields.items():
        default = "must be given" if field.is_required() else f"default {_as_given(field.get_default())}"
        limits = (
            (getattr(part, name, None), text) for part in field.metadata for name, text in LIMITS.items()
        )
        bounds = ", ".join(f"{text} {limit}" for limit, text in limits if limit is not None)
        text = f": {' '.join(field.description.split())}" if field.description else ""
        lines.append(f"{key} ({default}{'; ' + bounds if bounds else ''}){text}")
    return lines


def _as_given(default: Any) -> str:
    """A default as an experiment's YAML gives it."""
    from pydantic_core import to_jsonable_python

    return json.dumps(to_jsonable_python(default), ensure_ascii=False)


def _number(value: Any) -> str:
    many = isinstance(value, tuple | list)
    return ", ".join(f"{one:g}" for one in value) if many else f"{value:g}"
