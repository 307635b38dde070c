"""The designs' tables of docs/validation.md."""

from benchmarks.validation.check import check_table, count_table, reasons
from benchmarks.validation.hull import hull_checks
from benchmarks.validation.identification import identification_checks
from benchmarks.validation.matching import independent_checks, matching_checks
from benchmarks.validation.pump_jet import pump_jet_checks


def design_parts() -> dict[str, str]:
    """The tables, and the reasons of what is missed, by their marks."""
    groups = {"pump-jet": pump_jet_checks(), "hull": hull_checks(), "matching": matching_checks()}
    groups["identification"] = identification_checks()
    parts = {"design count": count_table(groups), "design independent": check_table(independent_checks())}
    for name, checks in groups.items():
        parts[f"design {name}"] = check_table(checks)
        parts[f"design {name} missed"] = reasons(checks)
    return parts
