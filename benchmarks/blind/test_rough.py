"""The table of level R: what was named where no model is right."""

from typing import Any

from benchmarks.blind.rough import rough_table
from benchmarks.blind.score import judged
from benchmarks.blind.tables import parts


def scored(hidden: str | None, *named: str) -> dict[str, Any]:
    truth = {
        "level": "R",
        "kind": "single" if hidden else "clean",
        "effects": [{"effect": hidden}] if hidden else [],
        "size": 1.0,
        "outside": None,
        "hull": {},
        "by_run": [],
    }
    causes = [{"effect": one, "thruster": None, "parameters": {}, "groups": {}} for one in named]
    entries = {"verdict": "unexplained", "causes": causes, "indistinguishable": [], "elapsed_s": 9.0}
    return judged(truth, entries) | {"case": "R0001", "processor_s": 20.0}


def test_the_table_tells_what_was_named_alone_beside_others_and_of_nothing() -> None:
    answers = [scored("mass", "mass"), scored("mass", "mass", "wind"), scored(None), scored(None, "wind")]
    result = rough_table(answers)
    assert "| one effect, identified and no other | 0.500 (0.09 to 0.91; 2) | 0.85: missed |" in result
    assert "| one effect, identified, alone or with others | 1.000" in result
    assert "| no effect, a cause named | 0.500 (0.09 to 0.91; 2) | 0.02: missed |" in result
    assert "| R0001 | nothing | wind |" in result and "| R0001 | mass | mass + wind |" in result


def test_level_r_has_a_table_of_its_own() -> None:
    assert set(parts([scored("mass", "mass")])) == {"blind rough"}
