"""A diagnosis.json with given causes."""

import json
from pathlib import Path
from typing import Any


def estimate(value: float, doubt: float, unit: str = "1") -> dict[str, Any]:
    return {"value": value, "standard_error": doubt, "unit": unit}


def diagnosis(folder: Path, *causes: dict[str, Any], correlation: list[list[float]] | None = None) -> Path:
    empty: dict[str, Any] = {
        name: [] for name in ("indistinguishable", "contrasts", "leftover", "candidates", "unseen", "gain")
    }
    found = empty | {"verdict": "cause", "causes": list(causes), "separating_trial": None}
    found |= {"correlation": correlation or []}
    path = folder / "diagnosis.json"
    path.write_text(json.dumps(found | {"noise": {}, "adequacy": {}, "elapsed_s": 1.0}))
    return path


CURRENT: dict[str, Any] = {
    "effect": "current",
    "parameters": {"north": estimate(0.2, 0.02, "m/s"), "east": estimate(-0.1, 0.03, "m/s")},
}
WEAK = {"effect": "thruster_gain", "thruster": "bs", "parameters": {"gain": estimate(0.02, 0.05)}}
