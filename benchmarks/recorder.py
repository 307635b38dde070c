"""How the recorder feels and how it lasts: delay from hand to boat, start of the page, hours of recording.

python benchmarks/recorder.py recorder.json

The page runs in headless Chromium beside `swamp-rl record`, in real time. The delay counts from the key's
event to the arrival of the first frame in which the boat obeys, and to the end of the drawing that shows it.
The hours are sailed as fast as the machine can, by a rule at the levers, through the same session and files.
"""

import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

PRESSES = 60
RUNS, EVERY = 640, 80  # eight hours at 45 s a visitor
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
RECORD = "import sys; from experiments.cli import main; sys.argv[0] = 'swamp-rl'; main()"


def delays(out: Path) -> dict[str, Any]:
    """Medians and 95th percentiles [ms] over key presses at random instants, and the page's start [s]."""
    from playwright.sync_api import sync_playwright

    command = [sys.executable, "-c", RECORD, "record", "--out", str(out), "--port", "0", "--scripted"]
    server = subprocess.Popen([*command, "--disturbances", "standard"], stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    address = re.findall(r"http\S+", server.stdout.readline())[0]
    waits = np.random.default_rng(0).uniform(0.15, 0.4, PRESSES)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        browser.new_page().goto("about:blank")
        page = browser.new_page(bypass_csp=True, viewport={"width": 1280, "height": 800})
        begun = time.perf_counter()
        page.goto(address)
        page.wait_for_selector("#seat:has-text('Leave')")
        start = time.perf_counter() - begun
        page.keyboard.down("ArrowUp")
        for number, wait in enumerate(waits):
            page.wait_for_timeout(1000 * wait)
            (page.keyboard.up if number % 2 else page.keyboard.down)("ArrowLeft")
            if page.evaluate("swamp.frame.phase") == "ended":
                page.keyboard.press("r")
        measured = np.array(page.evaluate("swamp.latencies"))
        frames = page.evaluate(COUNT_FRAMES)
        browser.close()
    server.terminate()
    server.wait(timeout=10)
    return {
        "page shown after, s": start,
        "frames received, 1/s": frames[0],
        "pictures drawn, 1/s": frames[1],
        **{f"key to frame, {name}": value for name, value in _spread(measured[:, 0]).items()},
        **{f"key to picture, {name}": value for name, value in _spread(measured[:, 1]).items()},
        "key presses": len(measured),
    }


COUNT_FRAMES = """async () => {
  let drawn = 0;
  const [begun, before] = [performance.now(), swamp.received];
  const draw = () => { drawn++; requestAnimationFrame(draw); };
  requestAnimationFrame(draw);
  await new Promise((resolve) => setTimeout(resolve, 3000));
  const seconds = (performance.now() - begun) / 1000;
  return [(swamp.received - before) / seconds, drawn / seconds];
}"""


def _spread(milliseconds: Any) -> dict[str, float]:
    return {
        "median, ms": float(np.median(milliseconds)),
        "95th percentile, ms": float(np.percentile(milliseconds, 95)),
    }


def hours(folder: Path) -> dict[str, Any]:
    """Memory [MiB] after every so many accepted runs, and how long the last acceptance took [s]."""
    from tests.driving import accept, drive, session

    game = session(folder, "standard")
    now, taken, memory = 0.0, 0.0, []
    while game.recordings.count < RUNS:
        now = drive(game, now)
        if game.journal is None:
            game.drop(again=False)
            continue
        begun = time.perf_counter()
        accept(game)
        taken = time.perf_counter() - begun
        if game.recordings.count % EVERY == 0:
            memory.append(_resident())
            print(
                f"{game.recordings.count} runs, {memory[-1]:.1f} MiB, accepted in {taken:.2f} s", flush=True
            )
    return {
        "hours sailed": now / 3600.0,
        "runs": RUNS,
        "memory, MiB": memory,
        "highest memory, MiB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        "last acceptance, s": taken,
    }


def _resident() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


def main(out: Path) -> None:
    """Measure both and write them."""
    with tempfile.TemporaryDirectory() as folder:
        measured = {"delay": delays(Path(folder) / "page"), "load average": os.getloadavg()[0]}
        for name, value in measured["delay"].items():
            print(f"{name:<36} {value:.1f}")
        measured["hours"] = hours(Path(folder) / "hours")
    out.write_text(json.dumps(measured, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
