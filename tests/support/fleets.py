"""Diagnoses that take no time, for tests of the fleet, and a fleet that a test can kill.

python -m tests.support.fleets OUT DATASET...
"""

import json
import shutil
import sys
import time
from pathlib import Path
from typing import Any

from swamp_rl.experiments.fleet import diagnose_fleet
from swamp_rl.experiments.fleet.work import INPUT, RESULT, answer_of

from swamp_rl.criticism.result import Cause, Diagnosis, Estimate, HeldOut
from swamp_rl.workers.processes import ProcessPool

COMPARISONS = 60


def cause(effect: str, parameter: str, value: float, error: float, gain: float, unit: str = "1") -> Cause:
    estimate = Estimate(value=value, standard_error=error, unit=unit)
    held_out = HeldOut(gain=gain, low=1.0, level=1.0 - 0.05 / COMPARISONS)
    return Cause(effect=effect, parameters={parameter: estimate}, held_out=held_out)


def diagnosis(*causes: Cause, **more: Any) -> Diagnosis:
    empty = ("indistinguishable", "contrasts", "leftover", "candidates", "unseen", "gain")
    given: dict[str, Any] = {name: [] for name in empty} | {"separating_trial": None, "noise": {}}
    verdict = "cause" if causes else "nothing_wrong"
    return Diagnosis(
        **given | {"verdict": verdict, "causes": list(causes), "adequacy": {}, "elapsed_s": 1.0} | more
    )


def pretend(job: str) -> str:
    """Write, a moment later, the dataset's `diagnosis_to_write.json` as `diagnose_one` would."""
    asked = json.loads(job)
    data, out = (
        json.loads((Path(asked["dataset"]) / "diagnosis_to_write.json").read_text()),
        Path(asked["out"]),
    )
    if "error" in data:
        return json.dumps(data)
    found = diagnosis(*(cause(**one) for one in data["causes"]), elapsed_s=time.perf_counter())
    shutil.rmtree(out, ignore_errors=True)  # `diagnose` replaces a whole folder by a whole folder
    out.mkdir()
    (out / RESULT).write_text(found.model_dump_json())
    time.sleep(data.get("seconds", 0.0))
    (out / INPUT).write_text(json.dumps(asked["input"]))
    return answer_of(found)


def datasets(folder: Path, meta: dict[str, Any]) -> list[Path]:
    """A folder for each name, with what its diagnosis is to say."""
    for name, result in meta.items():
        (folder / name).mkdir(parents=True)
        (folder / name / "diagnosis_to_write.json").write_text(json.dumps(result))
        (folder / name / "run.csv").write_text(name)
    return [folder / name for name in meta]


def main() -> None:
    out, *given = map(Path, sys.argv[1:])
    with ProcessPool(pretend, 2) as pool:
        diagnose_fleet(given, out, pool=pool, tell=lambda name, result: print(name, flush=True))


if __name__ == "__main__":
    main()
