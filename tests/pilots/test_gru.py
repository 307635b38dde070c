"""The gated recurrent unit as a pilot: torch's arithmetic in NumPy, and a memory for each boat."""

import numpy as np
import pytest
import torch

from swamp_rl.pilots.gru import GRUPilot, GRUSettings, fit_gru
from swamp_rl.runs import Run
from tests.support.steering_runs import RUNS, steered, wandering

POSE = ("north", "east", "cos_heading", "sin_heading")
QUICK = GRUSettings(senses=POSE, reaction=0.0, epochs=3, units=8)


def test_it_steps_as_torch_runs_a_whole_sequence() -> None:
    torch.manual_seed(0)
    memory, readout = torch.nn.GRU(4, 8, batch_first=True), torch.nn.Linear(8, 2)
    weights = {
        "mean": np.zeros(4),
        "scale": np.ones(4),
        "input": memory.weight_ih_l0.detach().numpy().T,
        "recurrent": memory.weight_hh_l0.detach().numpy().T,
        "input_bias": memory.bias_ih_l0.detach().numpy(),
        "recurrent_bias": memory.bias_hh_l0.detach().numpy(),
        "Wout": readout.weight.detach().numpy().T,
        "out": readout.bias.detach().numpy(),
    }
    pilot = GRUPilot(POSE, weights)
    seen = np.random.default_rng(0).normal(size=(3, 60, 4)).astype(np.float32)
    with torch.no_grad():
        expected = readout(memory(torch.tensor(seen))[0]).numpy()
    pilot.reset(3)
    levers = np.stack([pilot.act(seen[:, t]) for t in range(60)], axis=1)
    np.testing.assert_allclose(levers, np.clip(expected, [0.0, -1.0], [1.0, 1.0]), atol=1e-5)


def test_a_boat_that_begins_anew_forgets_and_the_others_do_not() -> None:
    pilot, seen = fit_gru(RUNS, QUICK), np.random.default_rng(0).normal(size=(20, 2, 4))
    pilot.reset(2)
    first = [pilot.act(row) for row in seen[:10]]
    pilot.reset_boats(np.array([False, True]))
    assert (pilot.memory[1] == 0.0).all() and (pilot.memory[0] != 0.0).any()
    again = [pilot.act(row[[1, 1]])[1] for row in seen[:10]]
    np.testing.assert_allclose(again, [row[1] for row in first], atol=1e-6)


def test_it_learns_a_steering_that_depends_on_the_past() -> None:
    late = [wandering(seed, lag=10) for seed in range(16)]
    pilot = fit_gru(late, GRUSettings(senses=POSE, reaction=0.0, epochs=40, units=16, learning_rate=1e-2))
    for unseen in (wandering(seed, lag=10) for seed in (97, 98, 99)):
        error = steered(pilot, unseen)[:, 1] - unseen.joypad[:, 1]
        without_memory = 0.5 * np.sin(unseen.columns["heading"]) - unseen.joypad[:, 1]
        assert np.square(error[20:]).mean() < 0.2 * np.square(without_memory[20:]).mean()


def test_what_lies_beyond_the_end_of_a_shorter_run_is_not_learned() -> None:
    """A batch of runs of one length, and the same with a long run that nobody taught in: the same losses."""
    idle = wandering(50, rows=400)
    untaught = Run("idle", idle.columns | {"driver": np.ones(400)}, idle.meta)
    taught = [Run(run.name, run.columns | {"driver": np.zeros(200)}, run.meta) for run in RUNS]
    whole = QUICK.model_copy(update={"batch_size": 9, "epochs": 1})
    spoilt = Run("idle", untaught.columns | {"joy_angle": np.full(400, -1.0)}, idle.meta)
    first, second = (fit_gru([*taught, run], whole).weights() for run in (untaught, spoilt))
    for name in first:
        np.testing.assert_array_equal(first[name], second[name])


def test_weights_that_do_not_fit_each_other_are_refused() -> None:
    weights = fit_gru(RUNS, QUICK).weights()
    with pytest.raises(ValueError, match="recurrent has the shape"):
        GRUPilot(POSE, weights | {"recurrent": np.zeros((8, 8))})
