"""The designed trial: its limits, its expected evidence, and what it decides."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from swamp_rl.boat import Boat, PropellerRudder, load_boat
from swamp_rl.boat.estimate import Kind
from swamp_rl.criticism.data.measurement_noise import noise_levels
from swamp_rl.criticism.data.run_set import RunSet
from swamp_rl.criticism.diagnose import examine
from swamp_rl.criticism.inference.next_trial import Designed, design_trial, question_of, write_trial
from swamp_rl.criticism.inference.trial_evidence import Explanation, Question, rate, refitted
from swamp_rl.criticism.likelihood.multiple_shooting import Shooting
from swamp_rl.criticism.likelihood.output_error import fit
from swamp_rl.criticism.model.candidates import Hypothesis, by_label, candidates
from swamp_rl.criticism.model.manoeuvres import manoeuvres
from swamp_rl.criticism.model.trial_limits import UNLIMITED, TrialLimits, rows_within, trial_limits
from swamp_rl.criticism.options import DEFAULT, using
from swamp_rl.criticism.report.next_trial import draw_next_trial, next_trial_sentences
from swamp_rl.criticism.result import Narrowed, NextTrial, Separated
from swamp_rl.effects import apply_effects, parse_effects
from swamp_rl.errors import UserError
from swamp_rl.runs import read_run
from swamp_rl.simulator import initial_state, parameters, simulate, tank
from swamp_rl.simulator.reference import reference_of
from swamp_rl.simulator.replay import replay
from tests.support.criticism import DT, SECONDS, SIGMA, driven, joined, select_effects
from tests.support.new_boats import new_boat

BOAT = load_boat("swamp")
ZIG_ZAG = manoeuvres(BOAT, DT, SECONDS)["zig-zag, 80 %"]
RESULT: dict[str, Any] = {
    "file": "next_trial.csv",
    "duration_s": 2.0,
    "hold_s": 1.0,
    "area_m": (20.0, 20.0),
    "start_m": (1.0, 1.0),
    "top_speed": 1.0,
    "evidence": 1.0,
    "of_list": [],
}
TRUTHS = {"thrust_scale": ("scale", 0.9), "resistance": ("scale", 1.2)}


def explained(name: str, value: float, deviation: float, boat: Boat = BOAT) -> Explanation:
    """An effect of one parameter, known to a standard deviation."""
    hypothesis = Hypothesis((by_label(candidates(boat, SECONDS))[name],))
    return Explanation(name, hypothesis, np.array([value]), np.array([[deviation**-2.0]]))


def runs_of(commands: np.ndarray) -> RunSet:
    """Runs under commands (R, T, 8) without measurements."""
    count, rows = commands.shape[:2]
    names = tuple(map(str, range(count)))
    return RunSet(BOAT, DT, names, commands, np.zeros((count, rows, 6)), np.full(count, rows))


def question(*names: str, column: int | None = None) -> Question:
    """Which of the effects is true, each known to one percent."""
    every = tuple(explained(name, TRUTHS[name][1], 0.01) for name in names)
    return Question(runs_of(ZIG_ZAG[None]), SIGMA, every, column)


NARROWS = Narrowed(effect="resistance", parameter="scale", unit="1", before=0.01, after=0.01)


@pytest.fixture
def brief() -> Iterator[None]:
    """A search that ends early."""
    with using(trial_budget=500_000):
        yield


def designed(asked: Question, area: str = "15x20", seed: int = 0, **more: Any) -> Designed:
    """A trial of 30 s."""
    limits = trial_limits(area, BOAT, 30.0, **more)
    narrows = NARROWS if asked.column is not None else None
    return design_trial(asked, narrows, limits, np.random.default_rng(seed))


def sailed(commands: np.ndarray, effects: Sequence[dict[str, Any]]) -> np.ndarray:
    """(T, S) states from rest at the origin, of a boat with those effects."""
    record = parameters(BOAT)
    apply_effects(record, parse_effects(list(effects), "test", BOAT.thruster_names), BOAT.thruster_names)
    start = initial_state(record, np.zeros((1, 3)))
    return np.asarray(
        simulate(record, tank(BOAT), start, commands[None, :-1].copy(), np.zeros(1, np.uint64), DT, 2)[0]
    )


@pytest.mark.usefixtures("brief")
def test_the_boat_keeps_the_area_and_the_limits_under_every_hypothesis() -> None:
    found = designed(question(*TRUTHS), speed=0.9, throttle=0.7)
    assert np.abs(found.commands[:, 4:]).max() <= 0.7
    for name, (parameter, value) in TRUTHS.items():
        states = sailed(found.commands, [{"effect": name, parameter: value}])
        places = states[:, :2] + found.result.start_m
        assert places.min() > 0.95 * 0.1 * 15.0
        assert (places < np.array([15.0, 20.0]) - 0.95 * 0.1 * 15.0).all()
        assert np.hypot(states[:, 3], states[:, 4]).max() < 0.91


@pytest.mark.usefixtures("brief")
@pytest.mark.parametrize(("names", "column"), [(tuple(TRUTHS), None), (("resistance",), 0)])
def test_the_trial_has_more_evidence_than_the_best_fixed_manoeuvre(
    names: tuple[str, ...], column: int | None
) -> None:
    result = designed(question(*names, column=column)).result
    assert result.of_list[0].evidence == max(one.evidence for one in result.of_list) > 0.0
    assert result.evidence > result.of_list[0].evidence


@pytest.mark.usefixtures("brief")
@pytest.mark.parametrize("share", [1.0, 0.5])
def test_a_propeller_turns_up_to_a_share_of_its_own_revolutions(tmp_path: Path, share: float) -> None:
    boat = new_boat(tmp_path, "propeller-rudder")
    commands = np.zeros((1, round(SECONDS / DT), 2))
    runs = RunSet(boat, DT, ("a",), commands, np.zeros((1, commands.shape[1], 6)), np.full(1, 1))
    asked = Question(runs, SIGMA, (explained("resistance", 1.2, 0.01, boat),), 0)
    limits = trial_limits("60x60", boat, 60.0, throttle=share)
    found = design_trial(asked, NARROWS, limits, np.random.default_rng(0))
    (propeller,) = boat.thrusters
    assert isinstance(propeller, PropellerRudder)
    assert found.commands[:, 1].max() == pytest.approx(share * propeller.revolutions_max)
    assert found.commands[:, 1].min() >= -share * propeller.revolutions_max_astern
    assert found.result.top_speed > 0.8 * share * reference_of(boat).speed


@pytest.mark.usefixtures("brief")
def test_commands_are_held_for_two_seconds_or_more() -> None:
    commands = designed(question(*TRUTHS)).commands
    changes = np.flatnonzero(np.abs(np.diff(commands, axis=0)).max(axis=1) > 0.0) + 1
    assert len(changes) > 0
    assert (np.diff([0, *changes]) * DT >= 2.0 - 1e-9).all()


@pytest.mark.usefixtures("brief")
def test_the_same_seed_gives_the_same_commands_and_another_one_others() -> None:
    once, again, other = (designed(question(*TRUTHS), seed=seed).commands for seed in (1, 1, 2))
    assert np.array_equal(once, again)
    assert once.shape != other.shape or not np.array_equal(once, other)


def test_expected_evidence_is_what_a_nonlinear_refit_of_noise_free_data_leaves() -> None:
    every = [explained(name, value, 1e3) for name, (_, value) in TRUTHS.items()]
    expected = rate(Question(runs_of(ZIG_ZAG[None]), SIGMA, tuple(every)), ZIG_ZAG[None], UNLIMITED)
    track = sailed(ZIG_ZAG, [{"effect": "thrust_scale", "scale": 0.9}])[:, :6]
    problem = Shooting(
        replace(runs_of(ZIG_ZAG[None]), measured=track[None]), np.tile(1 / SIGMA, (1, len(track), 1)), 20.0
    )
    states = track[problem.windows.first]
    left = fit(problem, every[1].hypothesis, every[1].x, states).chi2
    assert expected.least[0] == pytest.approx(expected.evidence[0, 1, 0], rel=0.3)
    assert expected.evidence[0, 1, 0] == pytest.approx(left, rel=0.3)


def test_the_expected_interval_is_that_of_a_fit_of_the_trial() -> None:
    asked = question("resistance", column=0)
    rated = rate(asked, ZIG_ZAG[None], UNLIMITED)
    track = sailed(ZIG_ZAG, [{"effect": "resistance", "scale": 1.2}])[:, :6]
    weight = np.tile(1 / SIGMA, (1, len(track), 1))
    problem = Shooting(replace(runs_of(ZIG_ZAG[None]), measured=track[None]), weight, 20.0)
    made = fit(problem, asked.explanations[0].hypothesis, np.array([1.2]), track[problem.windows.first])
    together = 1.0 / (0.01**-2 + 1.0 / made.covariance[0, 0])
    assert 0.01**2 / (1.0 + rated.least[0]) == pytest.approx(together, rel=0.3)


def test_a_trial_ends_where_any_track_exceeds_a_limit() -> None:
    tracks = np.zeros((2, 1, 100, 6))
    tracks[1, 0, :, 1] = np.arange(100) * 0.1  # to the east
    limits = trial_limits("20x8", BOAT)
    reach = 8.0 - 2.0 * BOAT.length
    assert rows_within(limits, tracks, BOAT.length)[0] == int(reach / 0.1) + 1
    tracks[0, 0, 7:, 3] = 2.0
    assert rows_within(replace(limits, speed=1.5), tracks, BOAT.length)[0] == 7


@pytest.mark.parametrize("area", ["40x30", "40 x 30", "40X30", "40×30"])
def test_an_area_is_read_as_the_report_writes_it(area: str) -> None:
    limits = trial_limits(area, BOAT)
    assert (limits.north, limits.east) == (40.0, 30.0)


@pytest.mark.parametrize("area", ["40x40ft", "40", "-3x40", "40 m x 40 m", "1x1", "nanx40", "40x1e9"])
def test_what_is_no_area_that_the_boat_can_move_in_is_refused(area: str) -> None:
    with pytest.raises(UserError, match=r"--next .*area"):
        trial_limits(area, BOAT)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"seconds": 5.0}, "--seconds 5"),
        ({"speed": 0.0}, "--top-speed 0"),
        ({"throttle": 1.5}, "--throttle 1.5"),
    ],
)
def test_limits_out_of_range_are_refused(given: dict[str, float], message: str) -> None:
    with pytest.raises(UserError, match=message):
        trial_limits("40x40", BOAT, **given)


def test_limits_without_any_evidence_are_refused() -> None:
    with using(trial_budget=1), pytest.raises(UserError, match="separate thrust_scale and resistance; widen"):
        designed(question(*TRUTHS), throttle=1e-4)


def test_limits_that_no_commands_keep_are_refused() -> None:
    none = TrialLimits(30.0, 1.0, 1.0)  # m each way, less than the margins
    with using(trial_budget=1), pytest.raises(UserError, match="keep the boat within the limits for 12 s"):
        design_trial(question(*TRUTHS), None, none, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("names", "column", "message"),
    [
        (("resistance", "resistance"), None, "within the limits separate resistance"),
        (
            ("resistance",),
            0,
            "narrow the interval of scale of resistance, whose standard error is 0.01; widen",
        ),
    ],
)
def test_a_trial_that_decides_nothing_is_refused_by_what_it_leaves_open(
    names: tuple[str, ...], column: int | None, message: str
) -> None:
    known = tuple(replace(one, precision=np.array([[1e16]])) for one in question(*names).explanations)
    asked = replace(question(*names, column=column), explanations=known)
    with using(trial_budget=1), pytest.raises(UserError, match=message):
        designed(asked)


@pytest.mark.usefixtures("brief")
def test_the_file_replays_to_the_motion_that_it_holds(tmp_path: Path) -> None:
    found = designed(question(*TRUTHS))
    write_trial(tmp_path, found, BOAT, DT)
    run = read_run(tmp_path / found.result.file)
    truth = sailed(found.commands, [{"effect": "thrust_scale", "scale": 0.9}])
    assert run.pose[:, :2] == pytest.approx(truth[:, :2] + found.result.start_m, abs=0.05)
    assert np.array_equal(run.commands(BOAT.thruster_names), found.commands)
    assert replay(BOAT, run).duration == run.duration


@pytest.mark.slow
@pytest.mark.numerical
@pytest.mark.usefixtures("brief")
def test_one_run_of_the_trial_makes_a_confounded_diagnosis_unique() -> None:
    truth = [{"effect": "linear_drag", "coefficient": 6.0}]
    possible = ("linear_drag", "thrust_scale", "resistance", "advance_thrust_loss")
    straight = np.zeros((3, round(SECONDS / DT), 8))
    straight[..., 4:] = 0.7
    steady = driven(truth, straight, 0.8, seed=9)
    found = select_effects(steady, *possible)
    assert found.rivals
    sigmas = noise_levels(steady)
    problem = Shooting(steady, np.ones_like(steady.measured), 20.0)
    asked = question_of(steady, sigmas, problem, found.winner, found.rivals)
    trial = design_trial(*asked, trial_limits("30x30", BOAT, SECONDS), np.random.default_rng(0))
    rows = np.concatenate([trial.commands, np.repeat(trial.commands[-1:], 400, axis=0)])[:400]
    more = driven(truth, rows[None], 0.0, seed=10)
    settled = select_effects(joined(steady, more), *possible)
    assert settled.winner.hypothesis.label == "linear_drag"
    assert not settled.rivals


@pytest.mark.slow
@pytest.mark.numerical
def test_without_rivals_and_causes_there_is_no_trial_to_design() -> None:
    clean = driven([], ZIG_ZAG[None].repeat(3, axis=0), 0.0, seed=3)
    problem = Shooting(clean, np.tile(1 / SIGMA, (3, len(ZIG_ZAG), 1)), 20.0)
    nothing = fit(problem, Hypothesis(), np.zeros(0), problem.initial_states())
    with pytest.raises(UserError, match="no trial to design"):
        question_of(clean, SIGMA, problem, nothing, [])


@pytest.mark.slow
@pytest.mark.numerical
def test_a_diagnosis_stands_where_there_is_no_trial_to_design() -> None:
    clean = driven([], ZIG_ZAG[None].repeat(3, axis=0), 0.0, seed=3)
    finding = examine(clean, None, np.random.default_rng(0), trial_limits("30x30", BOAT, SECONDS))
    assert finding.diagnosis.verdict == "nothing_wrong"
    assert finding.diagnosis.next_trial is None and finding.next_trial is None


@pytest.mark.parametrize(
    ("kind", "panels"),
    [
        ("four-azimuths", ["angle [°]", "throttle"]),
        ("twin-fixed", ["throttle"]),
        ("propeller-rudder", ["angle [°]", "revolutions [rps]"]),
    ],
)
def test_the_figure_has_the_quantities_that_the_thrusters_are_commanded_by(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: Kind, panels: list[str]
) -> None:
    boat = new_boat(tmp_path, kind)
    commands = np.zeros((20, 2 * len(boat.thrusters)))
    result = NextTrial(**RESULT)
    drawn: list[str] = []
    monkeypatch.setattr(Figure, "savefig", lambda self, _: drawn.extend(a.get_ylabel() for a in self.axes))
    draw_next_trial(
        tmp_path / "a.png", Designed(result, commands, ("mass",), np.zeros((1, 20, 6))), boat, 0.1
    )
    assert drawn == ["north [m]", *panels]


def test_a_standard_error_of_noise_free_runs_is_reported_with_its_digits() -> None:
    narrows = Narrowed(effect="mass", parameter="mass", unit="kg", before=1.234e-6, after=1.16e-7)
    result = next_trial_sentences(NextTrial(**RESULT, narrows=narrows))
    assert "a standard error of 1.2e-07 kg expected, 1.2e-06 kg now" in result[1]


def test_the_effects_of_one_explanation_are_joined_by_a_plus() -> None:
    effects = ["current by_run + resistance", "current by_run + linear_drag"]
    separated = Separated(effects=effects, separation=34.6)
    assert next_trial_sentences(NextTrial(**RESULT, separates=[separated]))[1] == (
        "34.6 standard errors expected between current (another in each run) + resistance and "
        "current (another in each run) + linear drag"
    )


@pytest.mark.usefixtures("brief")
def test_one_more_run_narrows_what_five_runs_scatter_by_as_six_runs_do() -> None:
    limits = trial_limits("15x20", BOAT, 30.0)
    asked, narrows = question("resistance", column=0), NARROWS.model_copy(update={"scatter": 5.0})
    result = design_trial(asked, narrows, limits, np.random.default_rng(0)).result
    assert result.narrows is not None
    assert result.narrows.after == pytest.approx(0.01 * math.sqrt(5 / 6), rel=0.02)
    assert "runs differ by more than noise" in " ".join(next_trial_sentences(result))


def test_explanations_that_a_refit_makes_equal_are_not_separated_though_linearised_they_are() -> None:
    wind = Hypothesis((by_label(candidates(BOAT, SECONDS))["wind"],))
    loose = np.diag([0.01, 0.01])  # a standard deviation of 10 m/s
    both = tuple(Explanation("wind", wind, np.array(x), loose) for x in ([1.0, 0.0], [7.0, 0.0]))
    asked = Question(runs_of(ZIG_ZAG[None]), SIGMA, both)
    rated = rate(asked, ZIG_ZAG[None], UNLIMITED)
    assert math.sqrt(rated.least[0]) > 10.0
    evidence, _ = refitted(asked, ZIG_ZAG[None], rated, 1)
    prior = ((7.0 - 1.0) / 10.0) ** 2
    assert evidence[0] == pytest.approx(prior, abs=DEFAULT.least_decrease)


@pytest.mark.usefixtures("brief")
def test_no_trial_separates_a_dead_thruster_from_a_gain_that_may_be_zero() -> None:
    dead, weak = explained("thruster_failure bs", 0.0, 1.0), explained("thruster_gain bs", 0.02, 0.01)
    result = designed(Question(runs_of(ZIG_ZAG[None]), SIGMA, (dead, weak))).result
    prior = (0.02 / 0.01) ** 2
    assert result.evidence == pytest.approx(prior, abs=DEFAULT.least_decrease)
