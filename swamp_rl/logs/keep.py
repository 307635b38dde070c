"""The rows of a log that its mapping keeps: afloat, armed, under way."""

from dataclasses import replace

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.runs.bad_rows import FEWEST_ROWS
from swamp_rl.runs.faults import Fault
from swamp_rl.runs.import_foreign import Foreign
from swamp_rl.runs.schema import RunMeta, of_part

KEEP = "keep"
"""Name in a mapping of what is not 0 in the rows to keep."""


def kept_parts(found: Foreign) -> list[Foreign]:
    """The table without its column KEEP, or its stretches of FEWEST_ROWS or more in which that is a number
    other than 0, named NAME-1, NAME-2 if there are several.

    UserError where there is no such stretch.
    """
    if KEEP not in found.table.columns:
        return [found]
    keep = np.nan_to_num(found.table.columns[KEEP], posinf=0.0, neginf=0.0) != 0.0
    edges = np.flatnonzero(np.diff(keep, prepend=False, append=False)).reshape(-1, 2).tolist()
    stretches = [slice(first, end) for first, end in edges if end - first >= FEWEST_ROWS]
    if not stretches:
        raise UserError(
            f"{found.file}: --map {KEEP}: is 0 or missing in all rows but stretches of fewer than "
            f"{FEWEST_ROWS}; it is not 0 in the rows to keep"
        )
    return [_part(found, chosen, number, len(stretches)) for number, chosen in enumerate(stretches, 1)]


def _part(found: Foreign, chosen: slice, number: int, count: int) -> Foreign:
    """The rows `chosen` as a table of its own, the part of that number."""
    table, total = found.table, len(found.table.rows)
    rows = table.rows[chosen]
    part = replace(
        table,
        columns={name: values[chosen] for name, values in table.columns.items() if name != KEEP},
        rows=rows,
        unread={name: values[chosen] for name, values in table.unread.items() if name != KEEP},
        faults=[fault for fault in table.faults if _within(fault, int(rows[0]), int(rows[-1]))],
    )
    whole = f"{number} of {count}: " if count > 1 else ""
    metadata = of_part(found.meta.model_dump(), first=chosen.start == 0, last=chosen.stop == total)
    metadata |= {"kept": f"{whole}rows {rows[0]} to {rows[-1]} of {total}"}
    name = found.name if count == 1 else f"{found.name}-{number}"
    return replace(found, name=name, table=part, meta=RunMeta.model_validate(metadata))


def _within(fault: Fault, first: int, last: int) -> bool:
    """Whether a fault is of a row from `first` to `last`, or of no row."""
    if fault.column == KEEP or fault.row is None:
        return fault.column != KEEP
    return fault.row <= last and (fault.last or fault.row) >= first
