"""The cards of learners: what each tells while it learns, with its spread over training seeds."""

from benchmarks.learners.tables import curves


def regression(losses: list[float]) -> dict[str, object]:
    return {"curve": [{"step": epoch, "loss": loss} for epoch, loss in enumerate(losses, 1)]}


def test_a_regression_shows_its_loss_and_dagger_its_success_and_what_is_fitted_at_once_nothing() -> None:
    rounds = [{"step": 0, "runs": 10, "success": 0.5}, {"step": 4, "runs": 14, "success": 0.9}]
    shown = curves(
        {
            "gru": {"0": regression([8.0, 6.0, 4.0, 2.0, 1.0]), "1": regression([4.0, 4.0, 2.0, 2.0, 0.5])},
            "dagger": {"0": {"curve": rounds}},
            "reservoir": {"0": {"curve": []}},
        }
    )
    gru, dagger = shown.splitlines()[2:]
    assert [cell.strip() for cell in gru.strip("|").split("|")] == [
        "gru",
        "loss",
        "5",
        "2",
        "6 (4 to 8)",
        "5 (4 to 6)",
        "3 (2 to 4)",
        "0.75 (0.5 to 1)",
    ]
    assert [cell.strip() for cell in dagger.strip("|").split("|")][4:] == [
        "0.5 (0.5 to 0.5)",
        "0.6 (0.6 to 0.6)",
        "0.7 (0.7 to 0.7)",
        "0.9 (0.9 to 0.9)",
    ]
    assert len(curves({"reservoir": {"0": {"curve": []}}}).splitlines()) == 2  # the heads alone
