"""The README's table of measured boats is that of their pages."""

from benchmarks.documents.measured_boats import README, boats_table


def test_the_readme_has_the_errors_of_the_pages() -> None:
    assert boats_table() in README.read_text(), "python -m benchmarks.documents.measured_boats"
