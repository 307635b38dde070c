"""The report that a person reads: the misfit first, then its name, then what it gains to add it."""

import base64
import html
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from swamp_rl.criticism.candidates import Hypothesis
from swamp_rl.criticism.gain import QUANTITIES
from swamp_rl.criticism.leftover import missing_forces

if TYPE_CHECKING:
    from swamp_rl.criticism.diagnose import Finding

SHOWN_RUNS = 6
SENTENCE = {
    "nothing_wrong": "What the simulation misses is what the sensors' noise explains.",
    "cause": "The misfit has a name.",
    "indistinguishable": "Several explanations fit these data equally well.",
    "unexplained": "Structure remains that no known effect explains; a cause below is part of it at most.",
}


def write_report(folder: Path, finding: "Finding") -> None:
    """Write report.html, self-contained, and its figures as PNG into `folder`."""
    figures = {
        "Measured and simulated tracks": _draw(folder / "tracks.png", finding, draw_tracks),
        "Prediction error by horizon": _draw(folder / "errors.png", finding, draw_errors),
        "Forces that the boat file lacks": _draw(folder / "forces.png", finding, draw_forces),
    }
    (folder / "report.html").write_text(page(finding, figures), encoding="utf-8")


def _draw(path: Path, finding: "Finding", draw: Callable[[Any, "Finding"], None]) -> bytes:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 6), layout="constrained")
    draw(figure, finding)
    figure.savefig(path, dpi=90)
    return path.read_bytes()


def page(finding: "Finding", figures: dict[str, bytes]) -> str:
    """The whole HTML page."""
    found = finding.diagnosis
    parts = [f"<h1>{found.verdict.replace('_', ' ')}</h1><p>{SENTENCE[found.verdict]}</p>"]
    for title, image in figures.items():
        data = base64.b64encode(image).decode()
        parts.append(f'<h2>{title}</h2><img alt="{title}" src="data:image/png;base64,{data}">')
    causes = [
        (f"{c.effect} {c.thruster or ''}", name, f"{p.value:.5g} ± {p.standard_error:.2g} {p.unit}")
        for c in found.causes
        for name, p in c.parameters.items()
    ] or [(c.effect, "", "") for c in found.causes]
    parts.append("<h2>Causes</h2>" + table(("effect", "parameter", "value and standard error"), causes))
    if found.indistinguishable:
        rows = [
            (", ".join(c.effects), f"{c.angle:.3f}", f"{c.evidence:.1f}", f"{c.mutual_refit:.1f}")
            for c in found.contrasts
        ]
        heads = (
            "explanations",
            "angle [rad]",
            "evidence [chi2]",
            "left of the other's synthetic data [chi2]",
        )
        parts.append("<h2>Not to be told apart</h2>" + table(heads, rows))
    if found.separating_trial:
        trial = found.separating_trial
        parts.append(
            f"<p>Trial that would tell: {trial.manoeuvre}, {trial.separation:.1f} standard errors.</p>"
        )
    if found.leftover:
        rows3 = [(one.force, one.variable, f"{one.explained:.0%}") for one in found.leftover]
        parts.append(
            "<h2>Where the rest lives</h2>" + table(("force", "goes with", "explained on other runs"), rows3)
        )
    rows4 = [
        (
            f"{g.horizon_s:g} s",
            name,
            f"{p['before']:.4g}",
            f"{p['after']:.4g}",
            "{:.3g} to {:.3g}".format(*p["ci95"]),
        )
        for g in found.gain
        for name, p in g.model_dump().items()
        if isinstance(p, dict)
    ]
    parts.append(
        "<h2>Gain on held-out runs</h2>" + table(("horizon", "error", "before", "after", "95 %"), rows4)
    )
    rows5 = [
        (c.effect, f"{c.held_out_score:.3f}", f"{c.gain:.0f}", "{:.0f} to {:.0f}".format(*c.gain_ci))
        for c in found.candidates
    ]
    parts.append("<h2>Candidates</h2>" + table(("effect", "held-out chi2 a sample", "gain", "95 %"), rows5))
    if found.unseen:
        parts.append(f"<p>These data cannot show: {html.escape(', '.join(found.unseen))}.</p>")
    style = (
        "body{font:16px sans-serif;max-width:60em;margin:2em auto}"
        "td,th{padding:.2em .8em;text-align:left}img{max-width:100%}"
    )
    head = f'<meta charset="utf-8"><title>Diagnosis</title><style>{style}</style>'
    return f"<!doctype html><html lang=en><head>{head}</head><body>{''.join(parts)}</body></html>\n"


def table(heads: tuple[str, ...], rows: list[Any]) -> str:
    """An HTML table."""
    if not rows:
        return "<p>None.</p>"
    top = "".join(f"<th>{html.escape(head)}</th>" for head in heads)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><tr>{top}</tr>{body}</table>"


def draw_tracks(figure: Any, finding: "Finding") -> None:
    """Measured tracks, and windows restarted from them under the boat file and under the extended boat."""
    problem, winner = finding.ladder.problems[1], finding.search.winner
    guess = finding.ladder.guesses[1]
    runs = min(SHOWN_RUNS, len(finding.trials.lengths))
    grid = figure.subplots(2 if runs > 3 else 1, min(3, runs), squeeze=False).ravel()
    tracks = [
        (problem.predict(Hypothesis(), np.zeros((1, 0)), guess[None])[0], "tab:red", "boat file"),
        (problem.predict(winner.hypothesis, winner.x[None], guess[None])[0], "tab:blue", "extended"),
    ]
    for run, axes in enumerate(grid[:runs]):
        measured = finding.trials.measured[run]
        axes.plot(measured[:, 1], measured[:, 0], color="0.6", lw=3, label="measured")
        for track, colour, label in tracks if winner.hypothesis.size else tracks[:1]:
            for w in np.flatnonzero(problem.windows.run == run):
                part = track[w, problem.windows.pad : problem.windows.steps[w] + 1]
                axes.plot(part[:, 1], part[:, 0], color=colour, lw=1, label=label)
                label = "_"
        axes.set(title=finding.trials.names[run], xlabel="east [m]", ylabel="north [m]", aspect="equal")
    grid[0].legend()


def draw_errors(figure: Any, finding: "Finding") -> None:
    """Root mean square errors against the horizon, before and after, and the sensors' noise."""
    gains = finding.diagnosis.gain
    names = [name for name in QUANTITIES if getattr(gains[0], name)]
    axes = figure.subplots(1, len(names), squeeze=False)[0]
    noise = finding.diagnosis.noise
    for ax, name in zip(axes, names, strict=True):
        kept = [(g.horizon_s, getattr(g, name)) for g in gains if getattr(g, name)]
        ax.loglog([h for h, _ in kept], [p.before for _, p in kept], "o-", color="tab:red", label="boat file")
        ax.loglog([h for h, _ in kept], [p.after for _, p in kept], "s-", color="tab:blue", label="extended")
        channel = {"position": "north"}.get(name.split("_rmse")[0], name.split("_rmse")[0])
        if channel in noise:
            ax.axhline(
                noise[channel] * (2**0.5 if channel == "north" else 1), color="0.6", ls="--", label="noise"
            )
        ax.set(xlabel="horizon [s]", title=name.replace("_rmse", "").replace("_", " "))
    axes[0].legend()


def draw_forces(figure: Any, finding: "Finding") -> None:
    """Missing surge and sway force and yaw moment against what the boat did, before anything is added."""
    forces = missing_forces(finding.trials, finding.weight, Hypothesis(), np.zeros(0))
    wanted = ("speed", "yaw rate", "heading", "time")
    thrusters = finding.trials.boat.thruster_names
    chosen = [*wanted, *(f"{kind} {thrusters[0]}" for kind in ("throttle", "azimuth"))]
    chosen = [name for name in chosen if name in forces.variables]
    axes = figure.subplots(3, len(chosen), squeeze=False, sharey="row")
    units = ("surge force [N]", "sway force [N]", "yaw moment [N m]")
    for row, unit in enumerate(units):
        for column, name in enumerate(chosen):
            ax = axes[row, column]
            ax.plot(forces.variables[name], forces.force[:, row], ".", ms=3)
            ax.axhline(0, color="0.6", lw=0.8)
            if row == 2:
                ax.set_xlabel(name)
        axes[row, 0].set_ylabel(unit)
