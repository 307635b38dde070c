"""In each ablation nothing but what its name says differs between pilots of a kind."""

from typing import Any

import pytest
from swamp_rl.experiments.config.load import load_experiment

VARIED = {
    "ablation_runs": ("runs", {5, 10, 20, 40}),
    "ablation_senses": ("options.senses", {4, 12}),
    "ablation_size": ("options.units", {25, 50, 100, 200, 400}),
    "ablation_outcomes": ("outcomes", {1, 4}),
}


def flat(values: dict[str, Any], above: str = "") -> dict[str, Any]:
    """Mappings in mappings as one, with dotted keys."""
    found = {}
    for key, value in values.items():
        found |= flat(value, f"{above}{key}.") if isinstance(value, dict) else {f"{above}{key}": value}
    return found


@pytest.mark.parametrize("name", VARIED)
def test_one_thing_is_varied_and_all_else_is_the_same(name: str) -> None:
    varied, expected = VARIED[name]
    plans = [flat(plan.model_dump(mode="json")) for plan in load_experiment(name).pilots.values()]
    for kind in {plan["kind"] for plan in plans}:
        alike = [plan for plan in plans if plan["kind"] == kind]
        differ = {key for key in alike[0] if len({str(plan[key]) for plan in alike}) > 1}
        assert differ == {varied}
        sizes = {len(v) if isinstance(v, list) else v for v in (plan[varied] for plan in alike)}
        assert sizes == expected
