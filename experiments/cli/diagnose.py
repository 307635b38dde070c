"""`swamp-rl diagnose` and `simulate --window`: a simulated boat against measured runs."""

import time
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from swamp_rl.experiments.cli.options import IgnoreOption, OwnBoatOption
from swamp_rl.experiments.cli.outputs import refuse_suffix

from swamp_rl.counted import counted, few
from swamp_rl.errors import UserError
from swamp_rl.names import YAML

if TYPE_CHECKING:
    from swamp_rl.boat import Boat
    from swamp_rl.criticism.model.trial_limits import TrialLimits
    from swamp_rl.criticism.result import Diagnosis, Estimate
    from swamp_rl.runs import Run


Datasets = Annotated[
    list[Path],
    typer.Argument(help="Folders of measured runs of one boat, or a YAML file of printed figures."),
]
Out = Annotated[Path, typer.Option(help="The folder to write.")]
Holdout = Annotated[
    Path | None, typer.Option(help="Runs held out to measure the gain; by default each run in turn.")
]
FitTo = Annotated[
    list[str] | None,
    typer.Option(
        help="Printed figures: groups fitted to in a stage, comma-separated; repeat for further stages."
    ),
]
NextTrial = Annotated[
    str | None,
    typer.Option(help="Design the next trial within an area in m north x m east, such as 40x40."),
]
TrialSeconds = Annotated[float | None, typer.Option(help="Duration of the next trial (s); 60 by default.")]
TrialSpeed = Annotated[
    float | None, typer.Option(help="Limit of the speed over ground in the next trial (m/s).")
]
TrialThrottle = Annotated[
    float | None, typer.Option(help="Throttle limit of the next trial, 0 to 1; 1 by default.")
]
SelfTrial = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        min=0,
        max=1000,
        help="Number of simulated replicates (twins) of the runs to diagnose; 0: none. 20 by default.",
    ),
]
SearchTwins = Annotated[
    bool,
    typer.Option("--search-twins", help="Run the full search on each twin (slow)."),
]
TwinWorkers = Annotated[
    int | None,
    typer.Option(min=1, max=1024, help="Processes of --search-twins; by default one for each processor."),
]


def diagnose(
    dataset: Datasets,
    out: Out,
    boat: OwnBoatOption = None,
    holdout: Holdout = None,
    fit: FitTo = None,
    ignore: IgnoreOption = None,
    next: NextTrial = None,
    seconds: TrialSeconds = None,
    top_speed: TrialSpeed = None,
    throttle: TrialThrottle = None,
    self_trial: SelfTrial = None,
    search_twins: SearchTwins = False,
    workers: TwinWorkers = None,
) -> None:
    """Identify the causes of a model's error in measured runs, extend the boat file, measure the gain."""
    given = few([str(one) for one in dataset])
    from swamp_rl.printed_figures.schema import is_figures_file
    from swamp_rl.runs.dataset import own_boat

    figures = [one for one in dataset if is_figures_file(one)]
    if figures:
        if len(dataset) > 1:
            raise UserError(f"{figures[0]}: printed figures are diagnosed alone; leave the other inputs out")
        if not boat:
            raise UserError(
                f"{figures[0]}: is read as printed figures, whose boat is needed: --boat NAME; runs are "
                "named by their folder"
            )
        if any(limit is not None for limit in (next, seconds, top_speed, throttle)):
            raise UserError(f"--next: {figures[0]} holds printed figures, not runs; leave it out")
        if self_trial is not None or search_twins or workers:
            raise UserError(
                f"--self-trial: {figures[0]} holds printed figures, which have none; leave it out"
            )
        typer.echo(f"diagnosing {given} against boat {boat}")
        _diagnose_figures(figures[0], boat, out, holdout, fit)
        return
    if fit:
        raise UserError(f"--fit: {given} holds runs, which have no groups; leave it out")
    if workers and not search_twins:
        raise UserError("--workers: only the searches of twins run in parallel; add --search-twins")
    if search_twins and self_trial == 0:
        raise UserError("--search-twins: --self-trial 0 asks for no twins; leave one of them out")
    boat = boat or str(own_boat(dataset[0]))
    typer.echo(f"diagnosing {given} against boat {boat}")
    _note_effects(boat)
    limits = _limits_of(next, boat, {"seconds": seconds, "speed": top_speed, "throttle": throttle})
    _diagnose_runs(dataset, boat, out, holdout, ignore or [], limits, self_trial, search_twins, workers)


def _note_effects(boat: str) -> None:
    """Name the effects of a boat file, as of the boat in which runs were simulated: none is found again."""
    from swamp_rl.boat import load_boat

    if effects := load_boat(boat).effects:
        typer.echo(
            f"  the boat file has {', '.join(one.label for one in effects)}: only what differs from these is "
            "named; to find them again, name a boat without them with --boat"
        )


def _diagnose_runs(
    dataset: list[Path],
    boat: str,
    out: Path,
    holdout: Path | None,
    ignore: list[str],
    limits: "TrialLimits | None",
    self_trial: int | None,
    search_twins: bool,
    workers: int | None,
) -> None:
    """`diagnose` on folders of measured runs."""
    began = time.perf_counter()
    from swamp_rl.experiments.cli.progress import progress

    from swamp_rl.boat import load_boat
    from swamp_rl.criticism.diagnose import diagnose as examine
    from swamp_rl.criticism.inference.self_trial import TWINS, Method
    from swamp_rl.criticism.progress import LOG
    from swamp_rl.workers import answers

    twins = TWINS if self_trial is None else self_trial
    method: Method = "search" if search_twins else "linearised"
    each = partial(answers, workers=workers)
    with progress(LOG):
        found = examine(dataset, boat, out, holdout, 0, ignore, twins, method, each, limits)
    for line in _lines_of(found, load_boat(boat), limits is not None):
        typer.echo(line)
    typer.echo(
        f"{out}: diagnosis.json, extended_boat.yaml, report.html ({time.perf_counter() - began:.0f} s)"
    )


def _lines_of(found: "Diagnosis", boat: "Boat", trial_asked: bool) -> Iterator[str]:
    """The lines that the terminal prints of a diagnosis of runs."""
    from swamp_rl.criticism.report.evidence import (
        carry_over_sentence,
        minor_sentence,
        predictors_sentence,
        self_trial_sentence,
        share_text,
        smoothed_sentence,
    )
    from swamp_rl.criticism.report.extension import extension_sentence
    from swamp_rl.criticism.report.next_trial import next_trial_sentences
    from swamp_rl.criticism.report.words import (
        in_file_names,
        is_extended,
        own_value,
        parameter_sets,
        separating_sentence,
        spread_sets,
    )

    yield f"verdict: {found.verdict}"
    for sentence in (predictors_sentence(found), carry_over_sentence(found), minor_sentence(found)):
        if sentence:
            yield f"  {sentence}"
    if found.verdict == "indistinguishable":
        yield "  the explanation with the lowest chi2:"
    for cause in found.causes:
        for where, parameters in parameter_sets(cause):
            own = partial(own_value, cause.effect, boat=boat)
            numbers = ", ".join(_number(name, p, own(name)) for name, p in parameters.items())
            yield f"  {in_file_names(cause.label)}{where}" + (f": {numbers}" if numbers else "")
        for name, value, interval, unit in spread_sets(cause):
            yield f"    {name}: {value} {unit} (95 % interval {interval})"
        if sentence := share_text(cause, found):
            yield f"    {sentence}"
    for names in found.indistinguishable:
        yield f"  cannot be distinguished: {in_file_names('; '.join(names))}"
    if sentence := separating_sentence(found):
        yield f"  {sentence}"
    if found.next_trial:
        yield "  next trial: " + "\n    ".join(next_trial_sentences(found.next_trial))
    elif trial_asked:
        yield "  next trial: none was designed; see the lines above"
    if sentence := self_trial_sentence(found):
        yield f"  {sentence}"
    for left in found.leftover[:1]:
        yield (
            f"  unexplained: {left.force}, a function of {left.variable} "
            f"({left.explained:.0%} of its variance on held-out runs)"
        )
    if sentence := extension_sentence(found, boat):
        yield f"  {sentence}"
    for gain in found.gain:
        if gain.horizon_s == 10.0 and gain.position_rmse_m:
            missed = gain.position_rmse_m
            extended = f", {missed.after:.3g} m with the extended boat" if is_extended(found) else ""
            yield (
                f"  position error 10 s ahead (root mean square): {missed.before:.3g} m with the boat file"
                f"{extended}"
            )
    if sentence := smoothed_sentence(found):
        yield f"  {sentence}"
    for number, step in enumerate(found.next_steps, 1):
        yield f"  next step {number}: {step}"
    for lack in found.missing_motion:
        yield f"  the runs lack {lack}"


def _limits_of(area: str | None, boat: str, more: dict[str, float | None]) -> "TrialLimits | None":
    """The limits of the next trial; None where none is asked for."""
    given = {name: value for name, value in more.items() if value is not None}
    if area is None:
        if given:
            raise UserError(
                "--seconds, --top-speed and --throttle are limits of --next; give an area with it"
            )
        return None
    from swamp_rl.boat import load_boat
    from swamp_rl.criticism.model.trial_limits import trial_limits

    return trial_limits(area, load_boat(boat), **given)


def _diagnose_figures(path: Path, boat: str, out: Path, holdout: Path | None, fit: list[str] | None) -> None:
    """`diagnose` on a YAML file of printed figures."""
    began = time.perf_counter()
    from swamp_rl.printed_figures.diagnose import diagnose_figures

    if holdout:
        raise UserError(f"--holdout: figures are held out by their groups; leave it out, see fit in {path}")
    stages = [[name.strip() for name in stage.split(",")] for stage in fit] if fit else None
    found = diagnose_figures(path, boat, out, stages)
    typer.echo(f"verdict: {found.verdict}")
    for number, stage in enumerate(found.stages, 1):
        named = " + ".join(stage.named) or "nothing"
        typer.echo(
            f"  stage {number} ({', '.join(stage.groups)}): {named}; chi2 of {stage.figures} figures "
            f"{stage.chi2_before:.1f} before, {stage.chi2_after:.1f} after"
        )
        for rival in stage.rivals:
            apart = "distinguished" if rival.distinguished else "not distinguished"
            typer.echo(
                f"    {apart} from {rival.effect} (-2 log likelihood {rival.evidence:.1f} higher; chi2 of "
                f"held-out figures {rival.of_the_first:.1f} against {rival.held_out_chi2:.1f})"
            )
    for cause in found.causes:
        on = f" {cause.thruster}" if cause.thruster else ""
        numbers = ", ".join(_number(name, p) for name, p in cause.parameters.items())
        typer.echo(f"  {cause.effect}{on}: {numbers}")
    for gain in found.gain:
        if gain.use == "judged":
            typer.echo(f"  {gain.group}, not fitted to: chi2 {gain.chi2_before:.1f} -> {gain.chi2_after:.1f}")
    for turned in found.exchange:
        typer.echo(
            f"  {turned.fitted} in place of {turned.judged}: {' + '.join(turned.named) or 'nothing more'}; "
            f"chi2 of {turned.judged} {turned.chi2_before:.1f} -> {turned.chi2_after:.1f}"
        )
    typer.echo(
        f"{out}: diagnosis.json, extended_boat.yaml, report.html ({time.perf_counter() - began:.0f} s)"
    )


def _number(name: str, found: "Estimate", own: str = "") -> str:
    """A parameter with unit and interval, and the boat file's `own` value, where it has one."""
    from swamp_rl.criticism.report.words import number_cells

    value, interval, unit = number_cells(found)
    plain = found.at_bound or not found.identifiable
    beside = f"; boat file {own}" if own else ""
    spread = f"({interval}{beside})" if plain else f"(95 % interval {interval}{beside})"
    return " ".join(part for part in (name.replace("_", " "), value, unit, spread) if part)


def disturbances(
    diagnosis: Annotated[Path, typer.Argument(help="What `diagnose` wrote: its folder or diagnosis.json.")],
    out: Annotated[Path, typer.Option(help="The .yaml file to write.")],
    among: Annotated[
        str | None,
        typer.Option(help="A name in configs/disturbances, or a file, to which the effects are added."),
    ] = None,
) -> None:
    """Write a diagnosis, with its standard errors, as disturbances for training."""
    from swamp_rl.experiments.config.posterior import diagnosed_boat, posterior_limits, write_posterior

    from swamp_rl.criticism.diagnose import RESULT

    refuse_suffix("--out", out, *YAML)
    diagnosis = diagnosis / RESULT if diagnosis.is_dir() else diagnosis
    level = write_posterior(diagnosis, out, among)
    boat = diagnosed_boat(diagnosis)
    has = "not its extended file, which has these effects already"
    suited = "" if boat is None else f"; for boat {boat}, {has}"
    typer.echo(f"{out}: {', '.join(entry['effect'] for entry in level['effects'])}{suited}")
    for line in posterior_limits(diagnosis):
        typer.echo(f"  {line}")


def simulate_windows(
    commands: Path, out: Path, boat: str, seconds: float, ignore: Sequence[str] = ()
) -> None:
    """`simulate --window`: the replay restarted every `seconds`, and the error at their ends."""
    import numpy as np

    from swamp_rl.boat import load_boat
    from swamp_rl.runs import read_run, write_run
    from swamp_rl.simulator.restarts import replay_restarted

    loaded, run = load_boat(boat), read_run(commands, lost_rows=True)
    found = replay_restarted(loaded, run, seconds, ignore)
    write_run(out, found.run)
    echo_unused(loaded, run)
    position, heading = np.sqrt(np.mean(found.miss**2, axis=0))
    typer.echo(
        f"{out}: {found.run.duration:.1f} s, restarted every {seconds:g} s; error at the end of "
        f"{counted(len(found.miss), 'window')} (root mean square): {position:.3g} m, "
        f"{np.degrees(heading):.3g} degrees"
    )


def echo_unused(boat: "Boat", run: "Run") -> None:
    """Name the columns of a run that its replay ignores, if it has any."""
    from swamp_rl.simulator.replay import unused_columns

    columns = unused_columns(boat, run)
    if columns:
        typer.echo(f"{run.name}: {', '.join(columns)}: ignored, fixed thrusters of boat {boat.name}")
