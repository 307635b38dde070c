"""Names in results, and of imported files: nothing outside the folder that was named is touched or shown."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given
from swamp_rl.experiments.artifacts.demo_runs import read_shown
from swamp_rl.experiments.evaluation.comparison import compare
from swamp_rl.experiments.reports.comparison import report
from swamp_rl.experiments.reports.leaderboard import gather, page
from swamp_rl.experiments.studies.stored import evaluate_folders

from swamp_rl.demo.page import write_page
from swamp_rl.evaluation import read_episodes, write_episodes
from swamp_rl.files import read_yaml, write_yaml
from swamp_rl.names import plain_name
from swamp_rl.runs import Run, append_run, create_dataset, read_dataset
from swamp_rl.runs.free_running import COLUMNS
from swamp_rl.runs.import_dataset import About, import_runs
from swamp_rl.runs.import_telemetry import FIELDS
from tests.support.hostile_names import EXAMPLES, HOSTILE, around, message_of, victims, written
from tests.support.result_folders import folder_of
from tests.support.runs import circling, described

HALFWAY = "../../victim/boat.yaml"


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Makes a new folder to work in, with victims beside it."""

    def made() -> Path:
        root = tmp_path_factory.mktemp("place")
        victims(root)
        (root / "here").mkdir()
        return root / "here"

    return made


@EXAMPLES
@given(pilot=HOSTILE, level=HOSTILE)
@example(pilot=HALFWAY, level="calm")
@example(pilot="[/red]", level="calm")
@example(pilot="reservoir", level=HALFWAY)
def test_no_pilot_or_level_in_results_reaches_out_of_a_comparison(here: Any, pilot: str, level: str) -> None:
    place = here()
    folder = folder_of(place / "results", {"reservoir": np.arange(9) < 5})
    table = read_episodes(folder / "episodes.parquet")["reservoir", "calm"]
    write_episodes(folder / "episodes.parquet", {(pilot, level): table})
    before = around(place)
    complaint = message_of(lambda: report(compare([folder], 0)))
    message_of(lambda: page(gather(place, 0)))
    assert around(place) == before
    for name in (pilot, level):
        assert complaint or (name.isprintable() and not set(name) & set("[]|<>`"))
    assert complaint or "/" not in level


@pytest.mark.parametrize("name", ["\x1b[2Jred", "line\nend", "\u202eevil", "<img src=x>", "a|b", "`code`"])
def test_a_folder_of_results_with_an_odd_name_is_refused(tmp_path: Path, name: str) -> None:
    folder_of(tmp_path / "good", {"ppo": np.arange(9) < 5})
    folder_of(tmp_path / name / "seed", {"ppo": np.arange(9) < 5}, 1)
    for act in (gather, lambda place: compare([place], 0)):
        assert "is not a name of a folder of results; rename it" in message_of(act, tmp_path)


def test_a_boat_that_is_markup_in_results_is_text_in_a_comparison(tmp_path: Path) -> None:
    file = folder_of(tmp_path, {"ppo": np.arange(9) < 5}) / "config" / "experiment.yaml"
    written(file, {**read_yaml(file), "boat": "a` <img src=x> `b"})
    assert r"a\` \<img src=x\> \`b on the course" in report(compare([tmp_path], 0))


@EXAMPLES
@given(name=HOSTILE, key=HOSTILE)
@example(name=HALFWAY, key="data")
def test_no_name_in_results_reaches_out_of_a_demo(here: Any, name: str, key: str) -> None:
    place = here()
    name = name.replace("{root}", str(place.parent))
    for driver in ("data", "driven/ppo"):
        create_dataset(place / "results" / driver, described())
        append_run(place / "results" / driver, Run("one", circling()))
    entries = {"race": {"runs": {key: name, "ppo": "one"}}, "data": {"source": name}}
    (place / "results" / "results.json").write_text(json.dumps(entries))
    before = around(place)
    message_of(lambda: write_page(place / "page.html", read_shown([place / "results"], [], "start")))
    assert around(place) == before
    assert {path.name for path in place.iterdir()} <= {"results", "page.html"}
    assert not (place / "page.html").exists() or "secret" not in (place / "page.html").read_text()


@EXAMPLES
@given(name=HOSTILE)
@example(name=HALFWAY)
def test_no_pilot_of_a_trained_folder_is_looked_for_elsewhere(here: Any, name: str) -> None:
    place = here()
    folder = folder_of(place / "results", {"reservoir": np.arange(9) < 5})
    data = read_yaml(folder / "config" / "experiment.yaml")
    plan = data["pilots"]["reservoir"]
    pilots = {name.replace("{root}", str(place.parent)): plan}
    written(folder / "config" / "experiment.yaml", {**data, "pilots": pilots})
    before = around(place)
    assert message_of(evaluate_folders, folder, out=place / "out")
    assert around(place) == before and not (place / "out").exists()


def telemetry() -> str:
    values = dict.fromkeys(FIELDS, "0.5") | {"sender": "1", "position_flags": "1", "velocity_flags": "1"}
    times = (1_700_000_000_000 + 100 * i for i in range(5))
    lines = (" ".join({**values, "utc": str(time), "utc_flags": "1"}.values()) for time in times)
    return "\n".join(lines) + "\n"


def free_running() -> str:
    rows = [",".join(str(0.1 * i) for _ in COLUMNS) for i in range(6)]
    return "\n".join([",".join(COLUMNS), *rows]) + "\n"


@pytest.mark.parametrize(
    ("kind", "text", "suffix"),
    [("telemetry", telemetry(), ".txt"), ("free-running", free_running(), ".csv")],
)
@EXAMPLES
@given(name=HOSTILE)
@example(name="one")
def test_a_log_is_imported_under_a_plain_name_or_not_at_all(
    here: Any, kind: Any, text: str, suffix: str, name: str
) -> None:
    place, name = here(), f"{name}{suffix}"
    assume("/" not in name and "\0" not in name and len(name.encode()) < 250)
    (place / "logs").mkdir()
    (place / "logs" / name).write_text(text)
    before = around(place)
    complaint = message_of(import_runs, [place / "logs"], kind, place / "out", About(group=name))
    assert around(place) == before
    if complaint:
        assert name != f"one{suffix}" and not (place / "out").exists()
    else:
        (run,) = read_dataset(place / "out").runs
        assert plain_name(run.name) == Path(name).stem


@pytest.mark.parametrize(("kind", "suffix"), [("telemetry", ".txt"), ("free-running", ".csv")])
def test_a_link_among_logs_is_refused(here: Any, kind: Any, suffix: str) -> None:
    place = here()
    (place / "logs").mkdir()
    (place / "logs" / f"one{suffix}").symlink_to(place.parent / "victim" / "boat.csv")
    assert "is a link" in message_of(import_runs, [place / "logs"], kind, place / "out")
    assert not (place / "out").exists()


def test_a_boat_whose_name_would_act_on_a_terminal_is_not_written(tmp_path: Path) -> None:
    assert "does not print" in message_of(write_yaml, tmp_path / "boat.yaml", {"name": "\x1b[2J"})
    assert list(tmp_path.iterdir()) == []
