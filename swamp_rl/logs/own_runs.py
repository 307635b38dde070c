"""Runs of a dataset of this project as logs: columns that a mapping does not give stay as they are."""

from dataclasses import replace

from swamp_rl.logs.defaults import VELOCITY, replaced
from swamp_rl.logs.expression import Name
from swamp_rl.logs.log import Log
from swamp_rl.logs.mapping import Mapping
from swamp_rl.runs.import_foreign import Foreign
from swamp_rl.runs.schema import DatasetMeta, RunMeta, entries_of


def own_mapping(log: Log, given: Mapping) -> Mapping:
    """Every column of a run as itself, but those that the given mapping has, or another source of."""
    (table,) = log.tables.values()
    names = [name for name in table.table.columns if not replaced(name, given.columns)]
    return Mapping({name: Name(name) for name in names if name not in given.columns})


def with_own_entries(found: Foreign, log: Log, dataset: DatasetMeta, given: Mapping) -> Foreign:
    """The run with the dataset's boat and its entries there, without the axes of velocities that the given
    mapping makes."""
    own = entries_of(dataset, log.file).model_dump()
    if VELOCITY & given.columns.keys():
        own.pop("velocity_axes", None)
    entries = {key: value for key, value in found.meta.model_dump().items() if value is not None}
    return replace(found, meta=RunMeta.model_validate(own | entries), dataset=dataset, home=log.home)
