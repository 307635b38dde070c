"""From the page to a trained pilot: ten runs are driven by keys in a browser, learned from, and evaluated."""

from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser
from swamp_rl.experiments.artifacts.stages import stages
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.config.scene import read_scene
from swamp_rl.experiments.training.coverage import starts_outside
from swamp_rl.experiments.training.train import get_data, train

from swamp_rl.evaluation import drive
from swamp_rl.runs import check_dataset, read_dataset
from tests.support.patience import patient
from tests.support.recorder import serving

pytestmark = pytest.mark.timed

RUNS, EPISODES = 10, 200
# A program at the keyboard: it reads what the page is sent, holds down the arrow keys that the rule of
# tests.support.driving.aim wants, and accepts each run, failed ones too. The page's commands are held back
# until the keys answer a frame, one command a frame: each moves the boat's clock on. One that the recorder
# dropped is said again.
KEYBOARD = """
const down = new Set();
let command = null, answered = -1, last = 0;
function hold(...wanted) {
  for (const [codes, type] of [[[...down].filter((key) => !wanted.includes(key)), "keyup"],
                               [wanted.filter((key) => !down.has(key)), "keydown"]]) {
    for (const code of codes) {
      type === "keyup" ? down.delete(code) : down.add(code);
      window.dispatchEvent(new KeyboardEvent(type, { code, bubbles: true }));
    }
  }
}
function steer(f) {
  const [north, east, heading] = f.pose;
  const gate = [[8, 0], [22, 8]][Math.min(f.passed, 1)];
  const ahead = 0.45 * Math.max(gate[0] - north - 1.5, 0);
  const target = ahead > 0 ? gate[0] - ahead : gate[0] + 2;
  const off = Math.atan2(gate[1] - east, target - north) - heading;
  const angle = 2 * (Math.atan2(Math.sin(off), Math.cos(off)) - 0.7 * f.velocity[2]);
  hold("ArrowUp", ...(angle > 0.35 ? ["ArrowRight"] : angle < -0.35 ? ["ArrowLeft"] : []));
}
function isDue(f) {
  const waited = performance.now() - last;
  return f.type === "frame" && waited > 7 && (f.phase !== "run" || f.time !== answered || waited > 1000);
}
window.WebSocket = class extends WebSocket {
  constructor(...where) {
    super(...where);
    const answer = ({ data }) => {
      const f = JSON.parse(data);
      if (!isDue(f)) return;
      [answered, last] = [f.phase === "run" ? f.time : -1, performance.now()];
      if (window.resting || f.phase === "saving") hold();
      else if (f.phase === "ended") { hold("Enter"); hold(); }
      else steer(f);
      if (command) super.send(command);
    };
    this.addEventListener("open", () => this.addEventListener("message", answer)); // the page hears it first
  }
  send(text) {
    if (JSON.parse(text).type === "command") command = text;
    else super.send(text);
  }
};
"""


@pytest.fixture(scope="module")
def recorded(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of runs, ten of them successful, driven by keys on the page."""
    folder = tmp_path_factory.mktemp("recorded") / "runs"
    with serving(folder, factor=None) as (address, hub):
        page = patient(browser.new_page(bypass_csp=True, viewport={"width": 320, "height": 240}))
        page.add_init_script(KEYBOARD)
        page.goto(address)
        for kept in range(1, 3 * RUNS + 1):
            page.wait_for_function(f"window.swamp?.status.count >= {kept}")
            listed = read_dataset(folder).runs
            if sum(run.meta.outcome == "success" for run in listed) >= RUNS:
                break
        page.evaluate("window.resting = true")
        page.close()
        assert hub.session.complaint() is None
    return folder


def test_the_runs_are_sound_and_begin_with_the_first_thrust_at_the_start(recorded: Path) -> None:
    assert check_dataset(recorded) == []
    good = [run for run in read_dataset(recorded).runs if run.meta.outcome == "success"]
    assert len(good) >= RUNS
    assert min(run.columns["joy_thrust"][0] for run in good) > 0.0
    for run in good:
        assert run.time[0] == 0.0
        assert run.meta.gates is not None and len(run.meta.gates) == 2 and run.meta.gates[0] > 0.0
        assert set(run.columns["joy_angle"]) <= {-1.0, 0.0, 1.0}


@pytest.mark.parametrize("name", ["reservoir-alone", "cloning"])
def test_a_pilot_that_learned_from_ten_keyboard_runs_succeeds_in_calm_water(
    recorded: Path, tmp_path: Path, name: str
) -> None:
    settings = [
        f"data.folder={recorded}",
        f"evaluation.episodes={EPISODES}",
        f"pilots.{name}.runs={RUNS}",
    ]
    scene = read_scene(load_experiment("camogli", settings))
    with stages() as progress:
        dataset = get_data(scene, tmp_path, progress)
    assert starts_outside(scene, dataset.runs) == 0.0
    pilot = train(scene, dataset, scene.experiment.pilots[name], lambda done: None)
    outcomes = drive(pilot, scene.boats_at("calm"), scene.seeds, lambda done: None).outcome
    assert np.mean(np.asarray(outcomes) == "success") >= 0.9
