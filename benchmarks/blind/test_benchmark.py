"""The blind benchmark: its bound on what can be known, its score, and the tables written from it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swamp_rl.experiments.synthetic.cases import (
    DT,
    RTK,
    Array,
    Case,
    draw_case,
    true_record,
    voyages,
    write_case,
)

from benchmarks.blind.bound import bound_of
from benchmarks.blind.cases import SEEDS, drawn, every_score, write_numbered
from benchmarks.blind.diagnose import asked_for, chosen, main
from benchmarks.blind.score import judged, share, summary
from benchmarks.blind.tables import judgement, parts, pictures
from benchmarks.blind.true_set import criterion_of_truth
from swamp_rl.boat import load_boat
from swamp_rl.criticism.data.run_set import read_run_set
from swamp_rl.simulator import tank
from swamp_rl.simulator.sensors import observe
from swamp_rl.simulator.step import simulate

pytestmark = [pytest.mark.slow, pytest.mark.numerical]

BOAT = load_boat("swamp")
# a single push from outside
PUSHED = next(number for number in range(1000) if drawn(number, "A")[0].names == ["external_force"])
NAME = f"A{PUSHED:04d}"


def test_the_bound_is_how_far_the_best_fit_to_noisy_data_scatters() -> None:
    case = Case("A", "single", [{"effect": "heading_bias", "bias": 0.1}])
    bound = bound_of(case, np.random.default_rng(4), True, runs=1, seconds=15.0)
    voyage = voyages(case, np.random.default_rng(4), 1, 15.0)[0]
    rng = np.random.default_rng(5)
    truth = observe(voyage.track[None], voyage.record, DT)[0]

    def predicted(numbers: Array) -> Array:
        record = np.repeat(true_record(BOAT, Case("A", "single", [])), len(numbers))
        record["heading_bias"] = 0.1 + numbers[:, 0]
        start = np.repeat(voyage.track[:1], len(numbers), axis=0)
        start[:, :6] += numbers[:, 1:]
        commands = np.repeat(voyage.commands[None, :-1], len(numbers), axis=0)
        track = simulate(record, tank(BOAT), start, commands, np.zeros(len(numbers), np.uint64), DT, 2)
        return np.asarray((observe(track, record, DT) / RTK).reshape(len(numbers), -1))

    np.testing.assert_allclose(predicted(np.zeros((1, 7)))[0], (truth / RTK).ravel(), atol=1e-6)
    slopes = (predicted(1e-4 * np.eye(7)) - predicted(-1e-4 * np.eye(7))) / 2e-4
    seen = (truth / RTK).ravel() + rng.standard_normal((400, truth.size))
    fitted = np.zeros((400, 7))
    for _ in range(3):  # Gauss and Newton
        fitted += np.linalg.lstsq(slopes.T, (seen - predicted(fitted)).T)[0].T
    assert bound.names == [("heading_bias", "bias")]
    assert np.std(fitted[:, 0]) / bound.deviation[0] == pytest.approx(1.0, abs=0.12)
    assert bound.evidence == pytest.approx(0.1 / bound.deviation[0])


def test_what_the_runs_cannot_show_has_no_useful_bound() -> None:
    straight_and_steady = Case("A", "confounded", [{"effect": "thrust_scale", "scale": 1.2}])
    both = Case("A", "confounded", [*straight_and_steady.effects, {"effect": "resistance", "scale": 1.2}])
    one, two = (
        bound_of(case, np.random.default_rng(1), True, 2, 20.0) for case in (straight_and_steady, both)
    )
    assert two.deviation[0] > 20 * one.deviation[0]


def test_a_confounded_case_neither_gathers_way_nor_turns() -> None:
    rng = np.random.default_rng(2)
    for voyage in voyages(draw_case(rng, "A", "confounded"), rng, 2, 20.0):
        assert np.ptp(voyage.track[:, 3]) < 1e-3
        assert np.abs(voyage.track[:, 5]).max() < 1e-6


@pytest.mark.parametrize("number", range(4))
def test_a_case_of_another_kind_reads_as_runs_of_its_boat(number: int, tmp_path: Path) -> None:
    write_numbered(number, "X", tmp_path / "data", tmp_path / "truth.json")
    truth = json.loads((tmp_path / "truth.json").read_text())
    trials = read_run_set(tmp_path / "data", load_boat(truth["boat"]))
    assert trials.dt == pytest.approx(1.0 / truth["instruments"]["rate"])
    assert len(trials.lengths) >= 2
    text = (tmp_path / "data" / "dataset.yaml").read_text()
    assert not any(effect["effect"] in text for effect in truth["effects"])


def test_small_faults_are_small_and_of_every_smooth_kind() -> None:
    cases = [drawn(number, "P")[0] for number in range(60)]
    assert all(3e-4 <= case.size <= 0.1 and len(case.effects) == 1 for case in cases)
    assert len({case.effects[0]["effect"] for case in cases}) == 36
    assert SEEDS[:4] == ("A", "B", "C", "D")  # whose places are seeds


def answers(folder: Path, verdict: str, causes: list[dict[str, Any]], **more: Any) -> dict[str, Any]:
    """Score of the case NAME, answered so."""
    for part in ("judged", "truth", f"answers/{NAME}"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    (folder / "truth" / f"{NAME}.json").write_text(json.dumps(vars(drawn(PUSHED, "A")[0])))
    timed = {"case": NAME, "error": "", "processor_s": 70.0, "alone_s": 40.0}
    (folder / "judged" / f"{NAME}.json").write_text(json.dumps(timed))
    answer = {"verdict": verdict, "causes": causes, "indistinguishable": [], "elapsed_s": 1.0} | more
    (folder / "answers" / NAME / "diagnosis.json").write_text(json.dumps(answer))
    return every_score(folder)[0]


def push(*errors: float) -> list[dict[str, Any]]:
    """The cause of the case NAME, north off by two of its errors."""
    effect = drawn(PUSHED, "A")[0].effects[0]
    numbers = {
        name: {"value": effect[name] + off * error, "standard_error": error, "unit": "N"}
        for name, off, error in zip(("north", "east"), (2.0, 0.0), errors, strict=True)
    }
    return [{"effect": "external_force", "thruster": None, "parameters": numbers}]


def test_stated_errors_are_held_against_the_truth_and_against_the_bound(tmp_path: Path) -> None:
    bound = bound_of(*drawn(PUSHED, "A")).deviation
    score = answers(tmp_path, "cause", push(2.0 * bound[0], bound[1]))
    assert [number["away"] for number in score["estimates"]] == pytest.approx([2.0, 0.0])
    assert score["estimates"][0]["bound"] == pytest.approx(bound[0])
    rates = summary([score])
    assert rates["interval_coverage"]["rate"] == 0.5
    assert rates["error_within_1.5_of_bound"]["rate"] == 0.5  # twice that of north, and that of east
    assert rates["error_over_bound_median"] == pytest.approx(1.5)


def test_a_table_is_written_from_the_files_of_however_many_cases_are_done(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    answers(tmp_path, "unexplained", push(0.001, 0.001))
    note = tmp_path / "note.md"
    names = ("scores", "wrong answers", "by effect", "power")
    marks = "".join(f"<!-- blind {name} -->\nold\n<!-- end blind {name} -->\n" for name in names)
    note.write_text(f"before\n{marks}after\n")
    main(["--score-only", str(tmp_path), "--into", str(note)])
    text = note.read_text()
    # No small effects were diagnosed: their table stays.
    assert text.count("old") == 1 and "<!-- blind power -->\nold\n<!-- end blind power -->" in text
    assert text.startswith("before") and text.endswith("after\n")
    assert "|  | A |\n| :-- | --: |\n| cases | 1 |" in text
    assert "| A | single | external_force | unexplained | external_force | 1 | - |" in text
    assert (tmp_path / "blind_confusion.png").stat().st_size > 1000
    assert not (tmp_path / "blind_power.png").exists()


def test_one_kind_of_cases_is_chosen_by_its_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    asked = asked_for().parse_args(["--kind", "pair", "--level", "C", "--cases", "20"])
    assert [len(drawn(*one)[0].effects) for one in chosen(asked)] == [2, 2, 2, 2]
    with pytest.raises(SystemExit, match="2"):
        main(["--kind", "pair", "--level", "X"])
    assert "--kind" in capsys.readouterr().err


def test_the_truth_has_a_lower_criterion_than_an_effect_that_explains_nothing(tmp_path: Path) -> None:
    case = Case("A", "single", [{"effect": "thruster_gain", "thruster": "bp", "gain": 0.7}])
    rng, data, truth = np.random.default_rng(3), tmp_path / "data", tmp_path / "truth.json"
    write_case(case, rng, data, truth, runs=2, seconds=40.0)
    entries = {"minor": [], "nuisance": []}
    gain = {
        "effect": "thruster_gain",
        "thruster": "bp",
        "scope": "boat",
        "parameters": {"gain": {"value": 0.7}},
    }
    drag = {
        "effect": "resistance",
        "thruster": None,
        "scope": "boat",
        "parameters": {"scale": {"value": 1.0}},
    }
    hidden = json.loads(truth.read_text())
    assert criterion_of_truth(data, hidden, entries | {"causes": [gain]}) == pytest.approx(0.0, abs=1e-6)
    apart = criterion_of_truth(data, hidden, entries | {"causes": [drag]})
    assert apart is not None and apart < -100.0
    assert criterion_of_truth(data, hidden, entries | {"causes": [drag | {"scope": "run"}]}) is None


def test_a_bar_is_reached_short_or_missed_by_what_chance_allows() -> None:
    def word(right: int, of: int, row: str = "single_named_alone") -> str:
        return judgement(row, "A", share([True] * right + [False] * (of - right)))

    assert (word(199, 200), word(193, 200), word(170, 200)) == ("reached", "short", "missed")
    assert (word(3, 200, "clean_false_positive"), word(20, 200, "clean_false_positive")) == (
        "reached",
        "missed",
    )
    assert (word(190, 200, "interval_coverage"), word(200, 200, "interval_coverage")) == ("reached", "missed")
    assert judgement("clean_false_positive", "D", share([True])) == ""


def test_small_faults_and_wrong_sets_stand_in_the_tables(tmp_path: Path) -> None:
    score = answers(tmp_path, "indistinguishable", [], indistinguishable=[["wind", "current"]])
    scores = [score, score | {"level": "P", "evidence": 5.0, "size": 0.01}]
    tables = parts(scores)
    pictures(scores, tmp_path)
    assert all((tmp_path / f"blind_{name}.png").stat().st_size > 1000 for name in ("confusion", "power"))
    assert "a set without it" in tables["blind wrong answers"]
    assert "| 4 to 6 | 0.000" in tables["blind power"]


@pytest.mark.parametrize(
    ("explanations", "named", "first"),
    [
        (["mass", "wind", "external_force"], 1, 1),
        (["mass", "wind", "external_force", "current"], 0, 1),
        (["mass", "wind", "current", "external_force"], 0, 0),
    ],
    ids=["of three", "of four", "fourth of four"],
)
def test_a_small_effect_counts_by_its_place_among_the_explanations_too(
    explanations: list[str], named: int, first: int
) -> None:
    truth = vars(drawn(PUSHED, "A")[0]) | {"level": "P"}
    found = {"verdict": "indistinguishable", "causes": [], "minor": [], "elapsed_s": 1.0}
    score = judged(truth, found | {"indistinguishable": [explanations]})
    (written,) = parts([score | {"evidence": 7.0}]).values()
    row = next(line for line in written.splitlines() if line.startswith("| 6 to 9"))
    _, _, alone_or_small, among_first, *_ = (cell.strip() for cell in row.split("|"))
    assert (float(alone_or_small.split()[0]), float(among_first)) == (named, first)
