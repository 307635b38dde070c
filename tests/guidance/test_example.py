"""The example in docs/guidance.md runs and does what it says."""

from pathlib import Path
from typing import Any

import numpy as np


def test_the_example_holds_its_station() -> None:
    text = (Path(__file__).resolve().parents[2] / "docs" / "guidance.md").read_text(encoding="utf-8")
    names: dict[str, Any] = {}
    exec(text.split("```python\n")[1].split("```")[0], names)
    assert names["balance"].holds
    assert np.hypot(*names["track"][-100:, :2].T).max() < 0.05
