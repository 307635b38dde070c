"""The designs' tables of docs/validation.md."""

from collections.abc import Mapping

from benchmarks.validation.check import Check, check_table, count_table, reasons
from benchmarks.validation.hull import hull_checks
from benchmarks.validation.identification import identification_checks
from benchmarks.validation.matching import independent_checks, matching_checks
from benchmarks.validation.pump_jet import pump_jet_checks


def design_groups() -> dict[str, list[Check]]:
    """The checks by design."""
    return {
        "pump-jet": pump_jet_checks(),
        "hull": hull_checks(),
        "matching": matching_checks(),
        "identification": identification_checks(),
    }


def design_parts(groups: Mapping[str, list[Check]]) -> dict[str, str]:
    """The tables, and the reasons of what is missed, by their marks."""
    parts = {"design count": count_table(groups), "design independent": check_table(independent_checks())}
    for name, checks in groups.items():
        parts[f"design {name}"] = check_table(checks)
        parts[f"design {name} missed"] = reasons(checks)
    return parts
