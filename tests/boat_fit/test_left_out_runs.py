"""`identify boat` on runs of which some have another thrust."""

from dataclasses import replace
from pathlib import Path

import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat_fit import identify
from swamp_rl.boat_fit.report import page_of, summary
from swamp_rl.criticism.progress import LOG
from swamp_rl.runs import append_run, inspect_dataset
from tests.support.from_scratch import written
from tests.support.quick_fit import fit_thrust_alone
from tests.support.sailing import sailed_dataset

WEED = "extends: twin.yaml\nname: weed\neffects: [{effect: thrust_scale, scale: 0.25}]\n"


@pytest.mark.slow
def test_runs_of_another_thrust_are_left_out_of_the_fit_and_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    written(tmp_path, "twin")
    (tmp_path / "weed.yaml").write_text(WEED)
    data, start = tmp_path / "runs", tmp_path / "twin.yaml"
    for name, boat, seed, count in (("runs", "twin", 0, 7), ("odd", "weed", 4, 2)):
        truth = load_boat(tmp_path / f"{boat}.yaml")
        sailed_dataset(tmp_path / name, start, truth, seed=seed, count=count, seconds=14.0, low=0.0)
    for number, run in enumerate(inspect_dataset(tmp_path / "odd").runs):
        append_run(data, replace(run, name=f"weed{number}"))

    fit_thrust_alone(monkeypatch, start)
    with caplog.at_level("INFO", LOG.name):
        found = identify.identify_boat(data, start, tmp_path / "new.yaml")
    assert caplog.text.count("windows of 5 s") == 1  # the runs are judged before the first fit
    named = {one.name.split(",")[0]: one.share for one in found.unlike.thrust}
    assert set(named) == {"weed0", "weed1"}
    assert named == pytest.approx(dict.fromkeys(named, 0.25), abs=0.1)
    assert "new" in page_of(found) and "`" not in page_of(found)
    message = " ".join(summary(found))
    assert "left out of the fit" in message and "held out" in message
    assert found.alike[1].boat_file < found.after[1].boat_file
