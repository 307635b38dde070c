"""`swamp-rl trial`: sea trials of a simulated boat, and the figures of simulated and measured ones."""

import re
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from swamp_rl.experiments.cli.options import BoatOption, OwnBoatOption, seed_option

from swamp_rl.counted import counted
from swamp_rl.errors import UserError

if TYPE_CHECKING:
    from swamp_rl.boat import Boat
    from swamp_rl.manoeuvres.plan import Plan

trial_app = typer.Typer(help="Automatic ITTC manoeuvres and their analysis.", no_args_is_help=True)

Out = Annotated[
    Path, typer.Option(help="The folder of the runs; their analysis goes to its folder analysis.")
]
Throttle = Annotated[list[float], typer.Option(help="Throttle, 0 to 1; may be repeated.")]
Angle = Annotated[
    list[float],
    typer.Option(
        help="Steering angle (deg), positive: first to starboard; may be repeated. "
        "Fixed thrusters: the inner side is throttled down by angle/90."
    ),
]
Pattern = Annotated[
    str, typer.Option(help="Azimuth thrusters: opposed (bow +, stern -), bow (bow alone) or parallel.")
]
StartSpeed = Annotated[float | None, typer.Option(help="Approach speed (m/s).")]
Direction = Annotated[float, typer.Option(help="Approach course (deg).")]
Seed = Annotated[int, seed_option("Seed of the wind's gusts.")]


def _carry_out(out: Path, boat: str, direction: float, seed: int, entry: dict[str, Any]) -> None:
    """Check an entry as one of a plan file, execute it and analyse it."""
    from swamp_rl.boat import load_boat

    given = {name: value for name, value in entry.items() if value is not None}
    data = {
        "name": "asked",
        "boat": boat,
        "seed": seed,
        "area": {"direction_deg": direction},
        "trials": [given],
    }
    keys = ("boat", "seed", "direction_deg", *entry)
    plan = _plan(data, {key: _option(key) for key in keys})
    _execute(plan, load_boat(boat), out)


def _option(key: str) -> str:
    """The option that gives a key of a plan, whose unit it does not have: --angle for `angle_deg`."""
    return f"--{key.removesuffix('_deg').removesuffix('_s').replace('_', '-')}"


def _plan(data: dict[str, Any], options: dict[str, str]) -> "Plan":
    """A validated plan; UserError that names the options of the keys at fault. options: by key."""
    from pydantic import ValidationError

    from swamp_rl.explain import explanations
    from swamp_rl.manoeuvres.plan import Plan

    try:
        return Plan.model_validate(data)
    except ValidationError as error:
        faults = [_of_options(*fault, options) for fault in explanations(error, Plan)]
        raise UserError("\n".join(faults)) from error


def _of_options(key: str, message: str, options: dict[str, str]) -> str:
    """A fault at a dotted key of a plan, such as `trials.0.angle_deg.0`, in terms of options."""
    own = next((options[part] for part in reversed(key.split(".")) if part in options), None)
    text = re.sub(r"\w+_\w+", lambda found: options.get(found[0], found[0]), message)
    return f"{own}: {text}" if own else text


def _execute(plan: "Plan", boat: "Boat", out: Path) -> None:
    """Carry out a plan with its boat and analyse it."""
    from swamp_rl.experiments.reports.trials import analyse_trials

    from swamp_rl.manoeuvres.record import record_trials

    record_trials(out, boat, plan.boat, plan.singly, plan.place, plan.seed)
    _say(*analyse_trials(out))


def _say(lines: list[str], out: Path) -> None:
    for line in lines:
        typer.echo(line)
    typer.echo(f"{out}: report.md, analysis.json and figures")


@trial_app.command("turning-circle")
def turning_circle(
    out: Out,
    angle: Angle,
    throttle: Throttle,
    boat: BoatOption = "swamp",
    turns: Annotated[int, typer.Option(help="Number of full turns; the second half counts as steady.")] = 6,
    duration: Annotated[float, typer.Option(help="Duration of the pull-out (s).")] = 30.0,
    pattern: Pattern = "opposed",
    start_speed: StartSpeed = None,
    direction: Direction = 0.0,
    seed: Seed = 0,
) -> None:
    """Turning circles at a steering angle, then a pull-out."""
    entry = {"manoeuvre": "turning-circle", "angle_deg": angle, "throttle": throttle, "turns": turns}
    more = {"duration_s": duration, "pattern": pattern, "start_speed": start_speed}
    _carry_out(out, boat, direction, seed, entry | more)


@trial_app.command("zig-zag")
def zig_zag(
    out: Out,
    angle: Angle,
    throttle: Throttle,
    heading: Annotated[
        list[float] | None,
        typer.Option(help="Execute heading (deg), one for each angle; by default the angle itself."),
    ] = None,
    boat: BoatOption = "swamp",
    executes: Annotated[int, typer.Option(help="Number of executes, the first included.")] = 6,
    pattern: Pattern = "opposed",
    start_speed: StartSpeed = None,
    direction: Direction = 0.0,
    seed: Seed = 0,
) -> None:
    """Zig-zag test; with --heading 1 the modified (very small) zig-zag."""
    entry = {"manoeuvre": "zig-zag", "angle_deg": angle, "heading_deg": heading or None, "throttle": throttle}
    more = {"executes": executes, "pattern": pattern, "start_speed": start_speed}
    _carry_out(out, boat, direction, seed, entry | more)


def _steered(kind: str, help: str) -> None:
    def verb(
        out: Out,
        angle: Angle,
        throttle: Throttle,
        boat: BoatOption = "swamp",
        pattern: Pattern = "opposed",
        start_speed: StartSpeed = None,
        direction: Direction = 0.0,
        seed: Seed = 0,
    ) -> None:
        entry = {"manoeuvre": kind, "angle_deg": angle, "throttle": throttle, "pattern": pattern}
        _carry_out(out, boat, direction, seed, entry | {"start_speed": start_speed})

    trial_app.command(kind, help=help)(verb)


_steered("spiral", "Direct spiral: steady yaw rates from one side to the other and back.")
_steered(
    "reverse-spiral", "Reverse spiral: the angles that hold yaw rates from one side to the other and back."
)


@trial_app.command("pull-out")
def pull_out(
    out: Out,
    angle: Angle,
    throttle: Throttle,
    boat: BoatOption = "swamp",
    duration: Annotated[float, typer.Option(help="Duration of each pull-out (s).")] = 30.0,
    pattern: Pattern = "opposed",
    start_speed: StartSpeed = None,
    direction: Direction = 0.0,
    seed: Seed = 0,
) -> None:
    """Steady turns to either side, each followed by steering amidships."""
    entry = {"manoeuvre": "pull-out", "angle_deg": angle, "throttle": throttle, "duration_s": duration}
    _carry_out(out, boat, direction, seed, entry | {"pattern": pattern, "start_speed": start_speed})


@trial_app.command()
def stopping(
    out: Out,
    throttle: Throttle,
    boat: BoatOption = "swamp",
    astern_throttle: Annotated[float, typer.Option(help="Astern throttle, 0 to 1.")] = 1.0,
    start_speed: StartSpeed = None,
    direction: Direction = 0.0,
    seed: Seed = 0,
) -> None:
    """Stopping test: full astern from steady speed until the boat is dead in the water."""
    entry = {"manoeuvre": "stopping", "throttle": throttle, "astern_throttle": astern_throttle}
    _carry_out(out, boat, direction, seed, entry | {"start_speed": start_speed})


@trial_app.command()
def straight(
    out: Out,
    throttle: Throttle,
    astern: Annotated[bool, typer.Option("--astern", help="Run astern instead.")] = False,
    boat: BoatOption = "swamp",
    duration: Annotated[float, typer.Option(help="Duration of the measured part (s).")] = 30.0,
    pattern: Pattern = "opposed",
    start_speed: StartSpeed = None,
    direction: Direction = 0.0,
    seed: Seed = 0,
) -> None:
    """Speed trial: steady speed at each throttle on a constant heading."""
    entry = {"manoeuvre": "straight", "throttle": throttle, "astern": astern, "duration_s": duration}
    _carry_out(out, boat, direction, seed, entry | {"pattern": pattern, "start_speed": start_speed})


@trial_app.command()
def plan(
    file: Annotated[str, typer.Argument(help="A name in configs/trials, or a plan file.")],
    out: Out,
    boat: Annotated[str | None, typer.Option("--boat", help="Boat to use in place of the plan's.")] = None,
) -> None:
    """Execute every manoeuvre of a plan file."""
    from swamp_rl.boat import load_boat
    from swamp_rl.errors import errors_at
    from swamp_rl.manoeuvres.plan import load_plan

    asked = load_plan(file)
    with errors_at(f"{file}: boat") if boat is None else nullcontext():
        vessel = load_boat(boat or asked.boat)
    _execute(asked.model_copy(update={"boat": boat or asked.boat}), vessel, out)


@trial_app.command()
def commands(
    file: Annotated[
        list[Path],
        typer.Argument(help="Runs (.csv or .parquet) whose commands are executed, such as next_trial.csv."),
    ],
    out: Annotated[Path, typer.Option(help="The folder for the runs.")],
    boat: BoatOption = "swamp",
) -> None:
    """Execute the commands of a file, such as that of `diagnose --next`, from its first state."""
    from swamp_rl.manoeuvres.commands import record_commands

    for run in record_commands(out, boat, file):
        typer.echo(f"{run.name}: {run.duration:.1f} s, {run.path_length:.1f} m")
    typer.echo(f"{out}: {counted(len(file), 'run')}")


@trial_app.command()
def analyse(
    dataset: Annotated[Path, typer.Argument(help="A folder of runs.")],
    out: Annotated[
        Path | None, typer.Option(help="The folder to write, DATASET/analysis by default.")
    ] = None,
    boat: OwnBoatOption = None,
) -> None:
    """Analyse recorded manoeuvres, measured or simulated."""
    from swamp_rl.experiments.reports.trials import analyse_trials

    _say(*analyse_trials(dataset, out, boat))
