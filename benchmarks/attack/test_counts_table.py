"""The table of counts: rows counted again are replaced, the others stay."""

from benchmarks.attack.counts import Count, table


def test_rows_that_were_not_counted_again_stay_in_their_order() -> None:
    before = table([Count("parsers", "b", 3, note="old"), Count("faults", "a", 1)], ("parsers", "faults"))
    found = table(
        [Count("parsers", "b", 10_000, ["x"], "new"), Count("parsers", "a", 2)], ("parsers", "faults"), before
    )
    assert found.splitlines()[2:] == [
        "| parsers | a | 2 | 0 |  |",
        "| parsers | b | 10,000 | 1 | new |",
        "| faults | a | 1 | 0 |  |",
    ]
    assert found.splitlines()[:2] == before.splitlines()[:2]
