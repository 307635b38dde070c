"""The picture of the recorder's page in docs/recording.md: the scripted pilot at the helm, gusts and current.

python -m benchmarks.recorder.picture docs/recorder.jpg
"""

import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

from benchmarks.recorder.measure import FLAGS, chromium, recorder
from swamp_rl.pilots.scripted import ScriptedPilot
from swamp_rl.pilots.store import save_pilot


def main(out: Path) -> None:
    """Let the pilot drive into the second leg and take the picture there."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        save_pilot(ScriptedPilot(0), Path(folder) / "pilot")
        words = ["--disturbances", "standard", "--pilot", f"{folder}/pilot"]
        with recorder(Path(folder) / "runs", *words) as address:
            browser = playwright.chromium.launch(executable_path=chromium(), args=FLAGS)
            page = browser.new_page(bypass_csp=True, viewport={"width": 1200, "height": 750})
            page.goto(address)
            page.fill("#nickname", "scripted pilot")
            page.keyboard.press("Enter")
            page.wait_for_selector("#seat:has-text('Leave')")
            page.keyboard.press("t")
            page.wait_for_function("swamp.frame.phase === 'run' && swamp.frame.pose[0] > 14", timeout=60_000)
            page.screenshot(path=out, type="jpeg", quality=84)
            browser.close()
    print(f"{out}: {out.stat().st_size / 1024:.0f} KiB")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
