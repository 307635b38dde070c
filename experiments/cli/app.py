"""The command line: one thin verb for each task, and one clear line when it cannot be done."""

import os
import re
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

import swamp_rl.experiments.cli.identify_boat
import swamp_rl.experiments.cli.identify_square
import swamp_rl.experiments.cli.runs_doctor
import swamp_rl.experiments.cli.runs_exchange
import swamp_rl.experiments.cli.trial_captive  # noqa: F401  it adds its verbs to `trial`
import typer
from swamp_rl.experiments.cli.boat import boat_app
from swamp_rl.experiments.cli.catalogue import boats, courses, effects, pilots
from swamp_rl.experiments.cli.compare import compare
from swamp_rl.experiments.cli.compiling import show_compiling
from swamp_rl.experiments.cli.demo import demo
from swamp_rl.experiments.cli.design import design_app
from swamp_rl.experiments.cli.diagnose import diagnose, disturbances
from swamp_rl.experiments.cli.experiment import evaluate, run, train
from swamp_rl.experiments.cli.export import export
from swamp_rl.experiments.cli.fleet import fleet
from swamp_rl.experiments.cli.guidance import capability, follow, follow_vehicle, hold
from swamp_rl.experiments.cli.help import add_help
from swamp_rl.experiments.cli.identify import identify_app
from swamp_rl.experiments.cli.link import helm, vehicle
from swamp_rl.experiments.cli.mission import mission
from swamp_rl.experiments.cli.options import BoatOption, CourseOption, IgnoreOption, seed_option
from swamp_rl.experiments.cli.outputs import guard_inputs, refuse_suffix
from swamp_rl.experiments.cli.record import record
from swamp_rl.experiments.cli.runs import runs_app
from swamp_rl.experiments.cli.signals import ENDED, heed_no_more, stoppable
from swamp_rl.experiments.cli.streams import usable_streams
from swamp_rl.experiments.cli.sweep import sweep
from swamp_rl.experiments.cli.trial import trial_app
from swamp_rl.experiments.cli.watch import watch

from swamp_rl import __version__
from swamp_rl.clipped import ACTS, printable
from swamp_rl.counted import counted
from swamp_rl.errors import UserError
from swamp_rl.ordinary import contents
from swamp_rl.own_code import fault_in_own_code

BAD_INPUT, INTERRUPTED, UNEXPECTED = 2, 130, 70
STOPPED = {128 + number: word for number, word in ENDED.items()}
"""Message of a verb that a signal has ended, by its exit code."""
RESUMABLE = [["run"], ["train"], ["evaluate"], ["sweep"], ["fleet"]]
"""Verbs that go on from what an interrupted life of the same command has left."""
DEBUG = "SWAMP_RL_DEBUG"
NAME = "swamp-rl"
NUMBA_SETTINGS, FIGURE_SETTINGS = ".numba_config.yaml", "matplotlibrc"

app = typer.Typer(
    name=NAME,
    help="Simulate small boats, train and evaluate pilots, identify and diagnose boat models.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
app.add_typer(boat_app, name="boat")
app.add_typer(runs_app, name="runs")
app.add_typer(identify_app, name="identify")
app.add_typer(trial_app, name="trial")
app.add_typer(design_app, name="design")
for verb in (
    run,
    train,
    evaluate,
    compare,
    diagnose,
    disturbances,
    demo,
    export,
    fleet,
    mission,
    vehicle,
    helm,
    follow,
    follow_vehicle,
    hold,
    capability,
    record,
    sweep,
    watch,
    effects,
    boats,
    courses,
    pilots,
):
    app.command()(verb)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"swamp-rl {__version__}")
        raise typer.Exit


@app.callback()
def _swamp_rl(
    version: Annotated[
        bool,
        typer.Option("--version", help="Print the version and exit.", callback=_print_version, is_eager=True),
    ] = False,
) -> None:
    pass


@app.command()
def simulate(
    commands: Annotated[
        Path, typer.Option(help="The recorded run (.csv or .parquet) to take commands from.")
    ],
    out: Annotated[Path, typer.Option(help="The .csv or .parquet file to write.")],
    boat: Annotated[
        str | None,
        typer.Option("--boat", help="Boat to simulate; by default that of the run's dataset, or else swamp."),
    ] = None,
    window: Annotated[
        float | None, typer.Option(help="Restart from the measured state at this interval (s).")
    ] = None,
    ignore: IgnoreOption = None,
) -> None:
    """Replay a run's commands from its first state through the simulator."""
    from swamp_rl.experiments.cli.diagnose import echo_unused, simulate_windows

    from swamp_rl.boat import load_boat
    from swamp_rl.runs import read_run, write_run
    from swamp_rl.runs.dataset import META, own_boat
    from swamp_rl.simulator.replay import replay

    if boat is None:
        within = (commands.parent / META).is_file()
        boat = str(own_boat(commands.parent)) if within else "swamp"
    if window is not None:
        simulate_windows(commands, out, boat, window, ignore or [])
        return
    loaded, run = load_boat(boat), read_run(commands)
    simulated = replay(loaded, run, ignore or [])
    write_run(out, simulated)
    echo_unused(loaded, run)
    typer.echo(f"{out}: {simulated.duration:.1f} s, {simulated.path_length:.1f} m")


@app.command("record-scripted")
def record_scripted_runs(
    out: Annotated[Path, typer.Option(help="The new folder of runs.")],
    course: CourseOption = "camogli",
    boat: BoatOption = "swamp",
    disturbances: Annotated[
        str | None, typer.Option(help="A name in configs/disturbances, or a file of them; none by default.")
    ] = None,
    count: Annotated[int, typer.Option(min=1, max=100_000, help="Number of successful runs.")] = 40,
    failed: Annotated[
        int, typer.Option(min=0, max=100_000, help="Number of failed runs, which are marked.")
    ] = 0,
    seed: Annotated[int, seed_option("Seed of the runs.")] = 0,
    skill: Annotated[
        Literal["novice", "usual", "expert"],
        typer.Option(help="Driver model: reaction time and rate of errors."),
    ] = "usual",
) -> None:
    """Record runs of the scripted pilot, a model of human drivers."""
    from swamp_rl.envs.batched import GatesVectorEnv
    from swamp_rl.experiments.artifacts.stages import stages

    from swamp_rl.pilots.record import record_scripted
    from swamp_rl.runs import read_dataset

    if out.exists():
        raise UserError(f"{out}: already exists; runs are recorded into a new folder, name another")

    def boats(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
        return GatesVectorEnv(n, boat=boat, course=course, disturbances=disturbances, observation=senses)

    with stages() as progress, progress.stage("recording successful runs", count) as tick:
        record_scripted(
            boats,
            out,
            boat=boat,
            course=course,
            count=count,
            failed=failed,
            seed=seed,
            skills=[skill],
            tick=tick,
            new=True,
        )
    recorded = read_dataset(out)
    typer.echo(f"{out}: {counted(len(recorded.runs), 'run')}, {len(recorded.successful)} of them successful")


@app.command()
def bench(
    out: Annotated[Path, typer.Option(help="The JSON file to write.")] = Path("bench.json"),
) -> None:
    """Measure speed relative to Gymnasium's Pendulum-v1."""
    from swamp_rl.experiments.studies.speed import MEANING, run_bench

    refuse_suffix("--out", out, ".json")
    for name, value in run_bench(out).items():
        typer.echo(f"{MEANING[name]:<54} {value:>12,.{0 if value >= 1000.0 else 3}f}")
    typer.echo(f"written to {out}")


add_help(app)
guard_inputs(app)


def main(stopped: Callable[[int], Any] = sys.exit) -> None:
    """Run the command line; whatever goes wrong is one line on the error stream and a non-zero exit.

    A verb that one of SIGNALS has ended exits with 128 and its number, however it ends then. Only Ctrl-C may
    be a verb's ordinary end, with 0: of those that go on until somebody ends them.

    stopped: ends the process with an exit code where a signal has ended the verb.
    """
    usable_streams()
    show_compiling()
    with stoppable() as signals:
        try:
            code, line = _carried_out(signals)
            heed_no_more()
        except KeyboardInterrupt:  # between the verb and its exit code
            heed_no_more()
            code, line = INTERRUPTED, ""
        if signals and (code or signals[0] != signal.SIGINT):
            line = line or ("" if code else "ended in order")
            code = 128 + signals[0]  # whatever became of the exception on its way
        if code in STOPPED:
            line = f"{STOPPED[code]}; {line or _kept(sys.argv[1:])}"
        if line:
            _complain(line)
        if code in STOPPED:
            stopped(code)
    sys.exit(code)


def _kept(words: list[str]) -> str:
    """What is left of the work of a command line that a signal has ended."""
    resumed = "; the same command resumes" if _verb(words)[:1] in RESUMABLE else ""
    return f"only what was finished is kept{resumed}"


def _verb(words: list[str]) -> list[str]:
    """The leading words of a command line that name a verb; an error of parsing does not always name it."""
    command, found = typer.main.get_command(app), list[str]()
    while len(found) < len(words) and words[len(found)] in getattr(command, "commands", {}):
        command = command.commands[words[len(found)]]  # type: ignore[attr-defined]
        found.append(words[len(found)])
    return found


def _carried_out(signals: list[int]) -> tuple[int, str]:
    """The exit code of what the command line asks for, and what to complain of; signals: those that came."""
    try:
        _refuse_odd_arguments()
        sys.argv[1:] = map(_from_home, sys.argv[1:])
        _refuse_settings_here()
        _refuse_environment()
        return app(prog_name=NAME, standalone_mode=False) or 0, ""
    except typer.TyperException as error:
        # Without any argument Typer has printed the help and has nothing to add.
        _in_our_words(error)
        line = " ".join(error.format_message().split())
        verb = " ".join([NAME, *_verb(sys.argv[1:])])
        return error.exit_code, f"{line} (see {verb} --help)" if line else ""
    except UserError as error:
        return BAD_INPUT, str(error)
    except SystemExit as ended:
        # Typer ends so where whoever was reading has had enough. What was begun is cleared away by then, and
        # the process ends at once: one of a hundred orderly exits is aborted by a thread of Arrow just begun.
        if isinstance(ended.__context__, BrokenPipeError):
            os._exit(1)
        raise
    except OSError as error:
        from swamp_rl.files import os_error

        return BAD_INPUT, str(os_error(error, "the operating system"))
    except MemoryError as error:
        return BAD_INPUT, f"{str(error) or 'no memory is left'}; ask for less at once"
    except (KeyboardInterrupt, typer.Abort):
        return INTERRUPTED, ""
    except Exception as error:
        if signals:
            return INTERRUPTED, ""
        if os.environ.get(DEBUG):
            raise
        if fault := fault_in_own_code(error):
            return BAD_INPUT, f"{fault} ({DEBUG}=1 shows the calls)"
        what = " ".join(f"unexpected {type(error).__name__}: {error}".split())
        return UNEXPECTED, f"{what}; {DEBUG}=1 shows where, please report it"


def _in_our_words(error: typer.TyperException) -> None:
    """Explain a value that an option cannot take as those in files are explained; every one is text."""
    from pydantic import ValidationError

    if isinstance(error.__cause__, ValidationError):
        from swamp_rl.explain import QUOTED, explanations

        error.message = explanations(error.__cause__, None)[0][1].removesuffix(QUOTED)


def _refuse_odd_arguments() -> None:
    """UserError for an argument that the locale does not decode, which no report could hold, and for one on
    which a terminal acts: a pattern of the shell may have found the name of a stranger's file."""
    for word in sys.argv[1:]:
        if re.search(f"[\t\n{ACTS}]", word):
            raise UserError(f"{word}: has a character that a terminal acts on; rename it")
        if any("\ud800" <= letter <= "\udfff" for letter in word):
            coding = sys.getfilesystemencoding()
            raise UserError(
                f"{word}: has bytes that are no text in {coding}; set LC_ALL=C.UTF-8, or rename it"
            )


def _from_home(word: str) -> str:
    """A word with the home folder in place of a ~ before its path, or before that of `--out=PATH`,
    `boat=PATH` and `onnx:PATH`: shells leave these as they are, and a folder of the name ~ would be made."""
    found = re.fullmatch("([^/~]*[=:])?(~/.*)", word)
    return (found[1] or "") + os.path.expanduser(found[2]) if found else word


def _refuse_settings_here() -> None:
    """UserError where there is no working directory, and for what libraries would read in it, perhaps that of
    a stranger's dataset: settings of numba change what is computed, and matplotlib ends at a file of settings
    that is no text."""
    try:
        os.getcwd()
    except FileNotFoundError as error:
        raise UserError("the working directory was removed; change to another one") from error
    if os.path.lexists(NUMBA_SETTINGS):
        raise UserError(
            f"{NUMBA_SETTINGS}: numba would take its settings from it; remove it, or work in another folder"
        )
    if os.path.lexists(FIGURE_SETTINGS):
        try:
            contents(FIGURE_SETTINGS, 2**20).decode()
        except (OSError, ValueError) as error:
            raise UserError(
                f"{FIGURE_SETTINGS}: matplotlib cannot read it ({error}); remove it or work elsewhere"
            ) from error


def _refuse_environment() -> None:
    """UserError for environment variables with which nothing is compiled, or no library is imported. Figures
    go to files, so a backend of matplotlib that a user's shell names, perhaps one that is not there, does not
    matter.
    """
    os.environ["MPLBACKEND"] = "agg"
    if not re.fullmatch("[0-9]{1,11}", given := os.environ.get("SOURCE_DATE_EPOCH", "0")):
        raise UserError(f"SOURCE_DATE_EPOCH is {given}: give seconds since 1970, or unset this variable")
    if (given := os.environ.get("NUMBA_DISABLE_JIT", "0")) not in ("", "0"):
        raise UserError(f"NUMBA_DISABLE_JIT is {given}: the simulator must be compiled; unset this variable")
    threads = os.environ.get("NUMBA_NUM_THREADS", "1").strip()
    if re.fullmatch("-[0-9]+|0+", threads):
        raise UserError(f"NUMBA_NUM_THREADS is {threads}: give 1 or more, or unset this variable")


def _complain(line: str) -> None:
    for word in sys.argv[1:]:  # a line end in a name begins no line of ours
        for part in filter(None, (word, word.partition("=")[2])):
            line = line.replace(part, printable(part))
    for fault in line.splitlines() or [""]:
        print("swamp-rl:", printable(" ".join(fault.split())), file=sys.stderr)
