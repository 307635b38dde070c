"""A fleet: every dataset is diagnosed once, whatever is killed, and the report is the same in any order."""

import json
import math
import os
import shutil
import subprocess
import sys
from contextlib import ExitStack
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urljoin, urlsplit

import numpy as np
import psutil
import pytest
from swamp_rl.experiments.fleet import diagnose_fleet
from swamp_rl.experiments.fleet.result import Fleet, Member
from swamp_rl.experiments.fleet.significance import adjusted, findings_of, p_value, shared_causes
from swamp_rl.experiments.fleet.work import INPUT, RESULT, diagnose_one
from swamp_rl.experiments.synthetic.cases import Case, write_case

from swamp_rl.criticism.result import Diagnosis, HeldOut
from swamp_rl.errors import UserError
from swamp_rl.runs import read_dataset
from swamp_rl.unfinished import folder_beside, locked
from tests.support.fleets import COMPARISONS, cause, datasets, diagnosis, pretend
from tests.support.patience import PATIENCE
from tests.support.sweep_pools import PoolHere

pytestmark = pytest.mark.timed

MASS = {"effect": "mass", "parameter": "mass", "value": 62.0, "error": 0.2, "gain": 80.0, "unit": "kg"}
DIAGNOSES: dict[str, Any] = {
    "red/may": {"causes": [MASS]},
    "red/june": {"causes": [{**MASS, "value": 65.0}]},
    "blue/may": {"causes": [{**MASS, "value": 60.0}]},
    "green/may": {"causes": []},
    "green/june": {"error": "green/june: no thrust in any run"},
}


def fleet(folder: Path, out: str = "out", size: int = 1, seed: int = 0) -> Fleet:
    given = [folder / "in" / name for name in DIAGNOSES]
    return diagnose_fleet(given, folder / out, pool=PoolHere(pretend, size, seed))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    datasets(tmp_path / "in", DIAGNOSES)
    return tmp_path


def without_times(found: Fleet) -> dict[str, Any]:
    return found.model_dump() | {"measured": None}


def test_the_report_names_what_is_shared_what_differs_and_what_failed(folder: Path) -> None:
    found = fleet(folder)
    assert [(one.cause, one.boats) for one in found.shared] == [("mass", ["blue", "red"])]
    (drift,) = found.drifts
    assert (drift.boat, drift.cause, drift.values) == ("red", "mass", {"red_june": 65.0, "red_may": 62.0})
    assert drift.p == pytest.approx(math.erfc(3.0 / (0.2 * math.sqrt(2.0)) / math.sqrt(2.0)))
    failed = {one.name: one.error for one in found.members if one.error}
    assert failed == {"green_june": "green/june: no thrust in any run"}
    page = (folder / "out" / "fleet.html").read_text()
    assert "5 datasets of 3 boats" in page
    assert "no thrust in any run" in page and "1 dataset could not be diagnosed" in page
    assert "red_june 65.00 ± 0.20; red_may 62.00 ± 0.20" in page
    assert Fleet.model_validate_json((folder / "out" / "fleet.json").read_text()) == found


def test_the_report_is_the_same_in_any_order_and_with_any_number_of_workers(folder: Path) -> None:
    one = fleet(folder)
    for size, seed in ((3, 1), (5, 2)):
        assert without_times(fleet(folder, f"out{size}", size, seed)) == without_times(one)
    backwards = diagnose_fleet(
        [folder / "in" / name for name in reversed(DIAGNOSES)], folder / "back", pool=PoolHere(pretend, 2, 3)
    )
    members = [one.model_dump(exclude={"dataset"}) for one in backwards.members]
    assert members == [one.model_dump(exclude={"dataset"}) for one in one.members]


def test_what_is_done_is_kept_and_what_changed_or_was_half_done_is_done_again(folder: Path) -> None:
    fleet(folder)
    out = folder / "out"
    (out / "blue_may" / "fleet_input.json").unlink()  # as when killed between the two
    (out / "blue_may" / "rest.txt").write_text("half done")
    (folder / "in" / "red" / "may" / "run.csv").write_text("another run")
    heard: list[str] = []
    given = [folder / "in" / name for name in DIAGNOSES]
    diagnose_fleet(given, out, pool=PoolHere(pretend, 1, 0), tell=lambda name, result: heard.append(name))
    assert sorted(heard) == ["blue_may", "green_june", "red_may"]
    assert not (out / "blue_may" / "rest.txt").exists()


@pytest.mark.slow
def test_killed_at_any_moment_the_same_command_goes_on(tmp_path: Path) -> None:
    entries = {f"boat{number}": {"causes": [MASS], "seconds": 0.3} for number in range(8)}
    given = datasets(tmp_path / "in", entries)
    asked = [sys.executable, "-m", "tests.support.fleets", *map(str, (tmp_path / "out", *given))]
    with subprocess.Popen(asked, stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None
        heard = [running.stdout.readline().strip() for _ in range(3)]
        workers = psutil.Process(running.pid).children(recursive=True)
        running.kill()
    assert psutil.wait_procs(workers, timeout=PATIENCE)[1] == [], "workers outlive their fleet"
    assert not (tmp_path / "out" / "fleet.json").exists()
    done = subprocess.run(asked, check=True, stdout=subprocess.PIPE, text=True, timeout=PATIENCE)
    again = done.stdout.split()
    assert set(again) <= set(entries)
    assert not set(again) & set(heard), "a dataset that had ended was diagnosed again"
    whole = json.loads((tmp_path / "out" / "fleet.json").read_text())
    unbroken = diagnose_fleet(given, tmp_path / "unbroken", pool=PoolHere(pretend, 1, 0))
    assert whole | {"measured": None} == json.loads(unbroken.model_dump_json()) | {"measured": None}


def test_what_is_no_fleet_is_refused_in_one_line(folder: Path) -> None:
    (folder / "other").mkdir()
    (folder / "other" / "notes.txt").write_text("mine")
    with pytest.raises(UserError, match="is no earlier fleet"):
        fleet(folder, "other")
    assert (folder / "other" / "notes.txt").read_text() == "mine"
    with pytest.raises(UserError, match="is given 2 times"):
        diagnose_fleet([folder / "in" / "red"] * 2, folder / "out")
    with pytest.raises(UserError):
        diagnose_fleet([folder / "in" / "red" / "may"], folder / "in" / "red")
    assert (folder / "in" / "red" / "may" / "run.csv").exists()
    with pytest.raises(UserError, match="lies in the dataset"):
        diagnose_fleet([folder / "in" / "red" / "may"], folder / "in" / "red" / "may" / "out")
    assert not (folder / "in" / "red" / "may" / "out").exists()


@pytest.mark.parametrize(
    "message", ["{", "[" * 100_000, '{"verdict": "cause"}', ""], ids=["cut", "deep", "another", "empty"]
)
@pytest.mark.parametrize("name", [RESULT, INPUT])
def test_a_dataset_with_a_damaged_state_is_diagnosed_again(folder: Path, name: str, message: str) -> None:
    whole = fleet(folder)
    (folder / "out" / "blue_may" / name).write_text(message)
    heard: list[str] = []
    given = [folder / "in" / one for one in DIAGNOSES]
    crew = PoolHere(pretend, 1, 0)
    found = diagnose_fleet(given, folder / "out", pool=crew, tell=lambda name, text: heard.append(name))
    assert sorted(heard) == ["blue_may", "green_june"]
    assert without_times(found) == without_times(whole)


def test_a_state_that_is_a_pipe_or_a_link_is_not_read(folder: Path) -> None:
    fleet(folder)
    for name, put in (("blue_may", os.mkfifo), ("red_may", lambda path: path.symlink_to("/dev/zero"))):
        (folder / "out" / name / INPUT).unlink()
        put(folder / "out" / name / INPUT)
        (folder / "out" / name / RESULT).unlink()
        put(folder / "out" / name / RESULT)
    found = fleet(folder)
    assert {one.name: one.error for one in found.members if one.error}.keys() == {"green_june"} | {
        name for name in ("blue_may", "red_may") if not (folder / "out" / name / RESULT).is_file()
    }


def half_done(job: str) -> str:
    """As a worker that is interrupted while it builds its folder."""
    out = Path(json.loads(job)["out"])
    with folder_beside(out, RESULT) as part:
        part.with_name(f".new-{out.name}-killed").mkdir()
        part.with_name(f".lock-{out.name}-killed").touch()
        raise KeyboardInterrupt


class Interrupted(ExitStack):
    """A worker that builds its folder, which is locked until the pool ends, when Ctrl-C comes."""

    size = 1

    def submit(self, number: int, job: str) -> None:
        out = Path(json.loads(job)["out"])
        self.callback(out.with_name(f".lock-{out.name}").touch)  # as the pool kills it
        self.enter_context(locked(out))
        out.with_name(f".new-{out.name}").mkdir()

    def wait(self) -> tuple[int, str | None, str]:
        raise KeyboardInterrupt


def test_an_interrupted_fleet_leaves_nothing_that_its_workers_were_building(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("swamp_rl.experiments.fleet.run.open_pool", lambda *asked: Interrupted())
    with pytest.raises(KeyboardInterrupt):
        diagnose_fleet([folder / "in" / name for name in DIAGNOSES], folder / "out")
    assert list((folder / "out").iterdir()) == []


def test_what_an_interrupted_fleet_was_building_is_removed_and_it_goes_on(folder: Path) -> None:
    given = [folder / "in" / name for name in DIAGNOSES]
    with pytest.raises(KeyboardInterrupt):
        diagnose_fleet(given, folder / "out", pool=PoolHere(half_done, 1, 0))
    assert list((folder / "out").iterdir()) == []
    (folder / "out" / ".new-red_may").mkdir()  # as when killed
    (folder / "out" / ".lock-red_may").touch()
    fleet(folder)
    assert (folder / "out" / "fleet.html").exists()


def test_a_second_fleet_in_the_folder_is_refused_while_the_first_is_at_work(folder: Path) -> None:
    (folder / "out" / ".new-red_may").mkdir(parents=True)
    (folder / "out" / ".lock-red_may").touch()
    with locked(folder / "out"), pytest.raises(UserError, match="another command is at work"):
        fleet(folder)


def test_a_folder_of_another_kind_in_a_datasets_place_is_not_removed(folder: Path) -> None:
    fleet(folder)
    shutil.rmtree(folder / "out" / "blue_may")
    (folder / "out" / "blue_may").mkdir()
    (folder / "out" / "blue_may" / "notes.txt").write_text("mine")
    elsewhere = folder / "elsewhere"
    shutil.move(folder / "out" / "red_may", elsewhere)
    (folder / "out" / "red_may").symlink_to(elsewhere)
    (elsewhere / INPUT).write_text("{}")
    found = fleet(folder)
    errors = {one.name: one.error or "" for one in found.members}
    assert "is not an earlier result" in errors["blue_may"] and "is a link" in errors["red_may"]
    assert (folder / "out" / "blue_may" / "notes.txt").read_text() == "mine"
    assert (elsewhere / RESULT).exists()


def test_a_dataset_that_changed_is_diagnosed_again_but_not_over_a_note(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def quick(dataset: Path, boat: str, out: Path, ignore: list[str], notes: dict[str, str]) -> Diagnosis:
        assert out == folder / "out" / "may"  # published once, with the note of its input
        with folder_beside(out, RESULT) as part:
            (part / INPUT).write_text(notes[INPUT])
            (part / RESULT).write_text(diagnosis().model_dump_json())
        return diagnosis()

    monkeypatch.setattr(import_module("swamp_rl.criticism.diagnose"), "diagnose", quick)
    notes = folder / "out" / "may" / "notes.txt"
    for rows, message in (("one", None), ("two", None), ("three", "notes.txt in it came or changed")):
        (folder / "in" / "red" / "may" / "run.csv").write_text(rows)
        if message:
            notes.write_text("mine")
        found = diagnose_fleet([folder / "in/red/may"], folder / "out", pool=PoolHere(diagnose_one, 1, 0))
        assert (message or "None") in str(found.members[0].error)
    assert notes.read_text() == "mine"


def test_a_link_in_the_place_of_the_fleet_is_refused(folder: Path) -> None:
    (folder / "there").mkdir()
    (folder / "out").symlink_to(folder / "there")
    with pytest.raises(UserError, match="is a link"):
        fleet(folder)
    assert list((folder / "there").iterdir()) == []


def test_names_are_text_in_the_page_and_links_lead_into_the_fleet(tmp_path: Path) -> None:
    names = ["<img src=x onerror=alert(1)>", "javascript:alert(1)", 'a" onclick="x', "b#c?d%41", "&lt;e"]
    given = datasets(tmp_path / "in", {name: {"causes": [MASS]} for name in names})
    diagnose_fleet(given, tmp_path / "out", pool=PoolHere(pretend, 1, 0))

    class Page(HTMLParser):
        def __init__(self) -> None:
            super().__init__()
            self.tags: list[tuple[str, dict[str, str | None]]] = []
            self.text = ""

        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            self.tags.append((tag, dict(attrs)))

        def handle_data(self, data: str) -> None:
            self.text += data + "\n"

    page = Page()
    page.feed((tmp_path / "out" / "fleet.html").read_text())
    assert all(name in page.text for name in names)
    assert not {tag for tag, _ in page.tags} & {"img", "script"}
    assert not any(name.startswith("on") for _, attributes in page.tags for name in attributes)
    links = [attributes["href"] or "" for tag, attributes in page.tags if tag == "a"]
    base = (tmp_path / "out").as_uri() + "/"
    found = [Path(unquote(urlsplit(urljoin(base, link)).path)).parent for link in links]
    assert sorted(found) == sorted(tmp_path / "out" / name for name in names)


def test_a_folder_without_a_dataset_has_its_line_and_does_not_stop_the_others(folder: Path) -> None:
    given = [folder / "in" / "red" / "may", folder / "in" / "red" / "never"]
    given[1].mkdir()
    found = diagnose_fleet(given, folder / "out", pool=PoolHere(pretend, 1, 0))
    assert [one.verdict for one in found.members] == [None, "cause"] or [
        one.verdict for one in found.members
    ] == ["cause", None]
    assert any("No such file" in (one.error or "") for one in found.members)
    shutil.rmtree(folder / "out")


def test_of_the_published_example_four_p_values_are_kept() -> None:
    # Benjamini and Hochberg 1995, section 4.1: fifteen hypotheses on thrombolysis
    p = [0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240, 0.4262, 0.5719]
    p += [0.6528, 0.7590, 1.0]
    assert (adjusted(p) <= 0.05).tolist() == [True] * 4 + [False] * 11
    assert adjusted([]).shape == (0,)


def test_the_p_value_is_that_of_a_split_likelihood_ratio_times_the_comparisons() -> None:
    held_out = HeldOut(gain=30.0, low=1.0, level=1.0 - 0.05 / 60.0)
    assert p_value(held_out) == pytest.approx(60.0 * math.exp(-15.0))
    assert p_value(held_out.model_copy(update={"gain": -3.0})) == 1.0


def test_a_weak_cause_stands_in_one_boat_and_falls_among_many() -> None:
    weak = diagnosis(cause("mass", "mass", 60.0, 1.0, 2.0 * math.log(COMPARISONS / 0.03)))
    members = [Member(name=str(k), boat=str(k), dataset=str(k)) for k in range(20)]
    alone, tests = findings_of(members[:1], {"0": weak})
    assert (tests, [one.kept for one in alone]) == (1, [True])
    among, tests = findings_of(members, {str(k): weak if k == 0 else diagnosis() for k in range(20)})
    assert (tests, [one.kept for one in among]) == (20, [False])
    assert shared_causes(among) == []


@pytest.mark.slow
def test_a_dataset_with_lost_rows_is_diagnosed_with_the_boat_that_it_names(tmp_path: Path) -> None:
    case = Case("A", "clean", [])
    write_case(case, np.random.default_rng(0), tmp_path / "log", tmp_path / "truth.json", 1, 40.0)
    with pytest.raises(UserError, match="after the row before"):
        read_dataset(tmp_path / "log")
    found = diagnose_fleet([tmp_path / "log"], tmp_path / "out", pool=PoolHere(diagnose_one, 1, 0))
    assert [(one.verdict, one.error) for one in found.members] == [("nothing_wrong", None)]
