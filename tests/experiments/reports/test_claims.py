"""What the report on the claims says of its data and of the demonstrator."""

from typing import Any

from swamp_rl.experiments.reports.claims import method, opening


def results(source: str, recorded_at: str | None, description: str = "") -> dict[str, Any]:
    return {
        "name": "small",
        "description": description,
        "data": {"source": source, "successful": 14, "recorded_at": recorded_at, "disjoint": True},
        "plan": {"pilot": "net", "draws": 8, "few": 4},
        "kind": "cloning",
        "takeover": 0.0,
        "episodes": 20,
    }


def test_runs_of_a_folder_have_no_level_and_no_known_program() -> None:
    text = opening(results("scripted", None))
    assert "The data are `scripted`: 14 successful runs that a program drove; none is of a person." in text
    assert "None" not in text and "scripted pilot" not in text
    assert "of the scripted pilot, a model of human drivers, at the level `calm`" in opening(
        results("scripted", "calm")
    )


def test_a_report_without_a_description_has_no_empty_lines_in_its_place() -> None:
    assert "\n\n\n" not in opening(results("human", None))
    assert "tested\n\nWhy.\n\nThe data are" in opening(results("human", None, "Why."))


def test_the_demonstrator_of_peoples_runs_is_who_drove_them() -> None:
    assert method(results("human", None)).endswith("*Demonstrator*: the driver of the data, by these runs.")
    assert method(results("scripted", "calm")).endswith(
        "*Demonstrator*: the scripted pilot in the same episodes."
    )
