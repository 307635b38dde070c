"""report.html with its figures, all in one file, and the figures again as PNG beside it."""

import base64
from pathlib import Path

from swamp_rl.criticism.inference.finding import Finding
from swamp_rl.criticism.report.figures import (
    Misfit,
    draw,
    draw_errors,
    draw_forces,
    draw_missing,
    draw_tracks,
)
from swamp_rl.criticism.report.next_trial import draw_next_trial
from swamp_rl.criticism.report.page import page


def write_report(folder: Path, finding: Finding) -> None:
    """Write report.html, self-contained, and its figures as PNG into `folder`."""
    misfit = Misfit.of(finding)
    paths = {
        "tracks": draw(folder / "tracks.png", misfit, draw_tracks),
        "errors": draw(folder / "errors.png", misfit, draw_errors),
        "forces": draw(folder / "forces.png", misfit, draw_forces),
    }
    if any(one.curve for one in finding.diagnosis.leftover):
        paths["missing"] = draw(folder / "missing.png", misfit, draw_missing)
    if finding.next_trial:
        paths["next_trial"] = draw_next_trial(
            folder / "next_trial.png", finding.next_trial, finding.run_set.boat, finding.run_set.dt
        )
    images = {name: base64.b64encode(path.read_bytes()).decode() for name, path in paths.items()}
    text = page(finding.diagnosis, finding.run_set, images)
    (folder / "report.html").write_text(text, encoding="utf-8")
