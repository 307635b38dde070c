"""Every shipped experiment, trained and evaluated for a few steps; a new file is picked up by itself."""

import json
from pathlib import Path

import pytest
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.smoke import EPISODES, MOST
from swamp_rl.experiments.studies.run import run_experiment

pytestmark = pytest.mark.slow

SHIPPED = sorted(path.stem for path in (Path(__file__).parents[3] / "configs" / "experiments").glob("*.yaml"))


@pytest.mark.usefixtures("no_figures")  # tests.experiments.studies.test_run looks at them
@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_experiment_goes_through_all_its_stages(tmp_path: Path, name: str) -> None:
    asked = load_experiment(name)
    out = run_experiment(name, ["smoke=true"], tmp_path / name)
    results = json.loads((out / "results.json").read_text())
    for pilot in asked.pilots if asked.claims is None else ():
        found = [message for called, message in results["pilots"].items() if called.split(",")[0] == pilot]
        assert found, pilot
        for message in found:
            assert list(message["levels"]) == [Path(level).stem for level in asked.evaluation.levels]
            assert all(level["episodes"] <= EPISODES for level in message["levels"].values())
    if asked.claims is not None:
        assert all(claim["verdict"] for claim in results["claims"])
    assert (out / "report.md").stat().st_size > 0


def test_a_smoke_run_is_small_and_has_a_name_of_its_own_and_the_same_when_read_again(tmp_path: Path) -> None:
    small, whole = load_experiment("camogli", ["smoke=true"]), load_experiment("camogli")
    assert (small.name, whole.name) == ("camogli-smoke", "camogli")
    assert small.pilots.keys() == whole.pilots.keys()
    assert small.pilots["ppo"].options["decisions"] == MOST["decisions"]
    assert small.pilots["ppo"].options["hold"] == whole.pilots["ppo"].options["hold"]
    (tmp_path / "again.yaml").write_text(json.dumps(small.model_dump(mode="json")))
    assert load_experiment(tmp_path / "again.yaml") == small
    more = load_experiment(tmp_path / "again.yaml", ["evaluation.episodes=20"])
    assert more.evaluation.episodes == 20  # as `evaluate --episodes` asks of a folder of results
