"""How the recorder feels and how it lasts: delay from hand to boat, start of the page, hours of recording;
and how soon a hundred runs are shown.

python -m benchmarks.recorder.measure docs/recording.md

writes the table that stands there between the two marks, of all parts or of those named after the file.
The page runs in headless Chromium beside `swamp-rl record`, in real time. The delay counts from the key's
event to the arrival of the first frame in which the boat obeys, and to the end of the drawing that shows it.
It was measured on a machine that others use too: the load is that of the minute, on its cores.
The hours are sailed as fast as the machine can, by a rule at the levers, through the same session and files;
each row is synchronised to the disk, so TMPDIR in memory makes them short.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import psutil
from swamp_rl.experiments.reports.experiment import table

from benchmarks.markers import write_parts

PRESSES = 60
HOURS, KEPT = 8, 8  # hours sailed; one in so many runs is accepted, the others are discarded
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
COMMAND = [sys.executable, "-m", "swamp_rl"]


def chromium() -> str | None:
    """The browser, as Debian installs it."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


@contextmanager
def recorder(out: Path, *words: str) -> Iterator[str]:
    """The address of a recorder in a process of its own."""
    command = [*COMMAND, "record", "--out", str(out), "--port", "0", "--scripted", *words]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    try:
        yield re.findall(r"http\S+", server.stdout.readline())[0]
    finally:
        server.terminate()
        server.wait(timeout=20)


def delays(address: str) -> dict[str, Any]:
    """Medians and 95th percentiles [ms] over key presses at random instants, and the page's start [s]."""
    from playwright.sync_api import sync_playwright

    waits = np.random.default_rng(0).uniform(0.15, 0.4, PRESSES)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium(), args=FLAGS)
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
    """Memory [MiB] along eight hours at the levers, and how long an acceptance took at most [s]."""
    from benchmarks.recorder.driver import drive, session

    game = session(folder, "standard")
    memory: list[float] = []
    now, taken, driven = 0.0, [0.0], 0
    while now < 3600.0 * HOURS:
        now = drive(game, now)
        driven += 1
        if game.journal is None or driven % KEPT:
            game.drop(again=False)
        else:
            begun = time.perf_counter()
            game.accept()()
            game.accepted()
            taken.append(time.perf_counter() - begun)
        if now // 3600.0 == len(memory) + 1:
            memory.append(_resident())
            print(f"{now / 3600.0:.2f} h, {driven} runs driven, {memory[-1]:.1f} MiB", flush=True)
    return {
        "hours": now / 3600.0,
        "runs driven": driven,
        "runs accepted": game.recordings.count,
        "memory each hour, MiB": memory,
        "longest acceptance, s": max(taken),
    }


def _resident() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


def hundred(folder: Path) -> dict[str, Any]:
    """Seconds until a hundred runs are recorded for rerun, and until its viewer can be opened on them."""
    from swamp_rl.envs.batched import GatesVectorEnv

    from swamp_rl.pilots.record import record_scripted

    record_scripted(
        lambda n, senses: GatesVectorEnv(n, disturbances="standard", observation=senses),
        folder,
        count=100,
        failed=0,
    )
    taken = {}
    for name, words in (("written", ["--save", f"{folder}.rrd"]), ("served", ["--web"])):
        begun = time.perf_counter()
        command = [*COMMAND, "demo", str(folder), *words]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as demo:
            assert demo.stdout is not None
            demo.stdout.readline()
            assert demo.stdout.readline(), "the demo ended early"
            taken[f"100 runs {name} after, s"] = time.perf_counter() - begun
            used = psutil.Process(demo.pid).cpu_times()
            taken[f"of its processor, {name}, s"] = used.user + used.system
            demo.terminate()
    return taken


def cells(measured: dict[str, Any]) -> list[list[str]]:
    """A row of the table for each number, of a list its first and last."""
    rows = []
    for name, value in measured.items():
        ends = [value[0], value[-1]] if isinstance(value, list) else [value]
        rows.append([name, " … ".join(f"{number:.3g}" for number in ends)])
    return rows


def main(out: Path, parts: list[str]) -> None:
    """Measure the parts and write them into the document."""
    for part in parts or ["delay", "hours"]:
        load = os.getloadavg()[0]
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name) / part
            if part == "delay":
                with recorder(folder, "--disturbances", "standard") as address:
                    measured = delays(address)
            else:
                measured = {"hours": hours, "hundred": hundred}[part](folder)
        measured["load average"], measured["cores"] = load, os.cpu_count()
        made = table(["measured", ""], cells(measured))
        print(made)
        write_parts(out, {part: made})


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
