"""A dataset as Minari keeps one (HDF5), for offline reinforcement learning."""

import json
import os
import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.extras import missing
from swamp_rl.runs.apart import apart
from swamp_rl.runs.dataset import Dataset
from swamp_rl.runs.episodes_of import LEVERS, Split, split_columns
from swamp_rl.runs.run import Run

ROOT = "MINARI_DATASETS_PATH"


COPIES = "swamp_rl_copies"


def write_minari(dataset: Dataset, folder: Path, name: str, copies: Mapping[str, bytes]) -> str:
    """Write it into `folder`, for Minari a root of datasets, and return its id there, NAME-v0.

    A run of T rows is an episode of T observations (the state) and T − 1 actions (the levers, else the
    commands). The reward is 1 in the last step of a run whose outcome is success, else 0; a run that ended
    by timeout or untold is truncated, any other terminated. `infos` holds every column with all its T rows,
    bit for bit; what dataset.yaml says is in the metadata, under `swamp_rl`, and the `copies` of boat and
    course under `swamp_rl_copies`. UserError without minari.
    """
    try:
        import h5py  # noqa: F401
        import minari  # noqa: F401
    except ImportError as error:
        raise missing("Minari's files need minari and h5py", "exchange") from error
    return _written(dataset, folder, name, copies)


@apart
def _written(dataset: Dataset, folder: Path, name: str, copies: Mapping[str, bytes]) -> str:
    from gymnasium.spaces import Box
    from minari import MinariDataset, create_dataset_from_buffers

    split = split_columns(dataset)
    identity = f"{re.sub(r'[^a-z0-9]+', '-', name.lower()).strip('-') or 'runs'}-v0"
    low, high = ((0.0, -1.0), (1.0, 1.0)) if split.action == LEVERS else (-np.inf, np.inf)
    with _root(folder), warnings.catch_warnings():
        # It would have a link to the code and a mail address.
        warnings.simplefilter("ignore", UserWarning)
        made: MinariDataset = create_dataset_from_buffers(
            identity,
            [_episode(number, run, split) for number, run in enumerate(dataset.runs)],
            observation_space=Box(-np.inf, np.inf, (len(split.state),), np.float64),
            action_space=_box(low, high, len(split.action)),
            description=f"observations: {', '.join(split.state)}; actions: {', '.join(split.action)}",
            data_format="hdf5",
        )
        metadata = dataset.meta.model_dump(exclude_none=True, exclude={"runs"})
        carried = {copy: held.decode() for copy, held in copies.items()}
        made.storage.update_metadata({"swamp_rl": json.dumps(metadata), COPIES: json.dumps(carried)})
    return identity


def _box(low: Any, high: Any, size: int) -> Any:
    from gymnasium.spaces import Box

    return Box(
        np.broadcast_to(np.array(low, float), size),
        np.broadcast_to(np.array(high, float), size),
        dtype=np.float64,
    )


@contextmanager
def _root(folder: Path) -> Iterator[None]:
    """Minari takes the place of its datasets from the environment only."""
    before = os.environ.get(ROOT)
    os.environ[ROOT] = str(folder)
    try:
        yield
    finally:
        os.environ.pop(ROOT)
        if before is not None:
            os.environ[ROOT] = before


def _episode(number: int, run: Run, split: Split) -> Any:
    from minari.data_collector import EpisodeBuffer

    steps = len(run.time) - 1
    last = np.arange(steps) == steps - 1
    cut = run.meta.outcome in (None, "timeout", "diverged")
    metadata = run.meta.model_dump(exclude_none=True, exclude={"file", "rows"})
    return EpisodeBuffer(
        id=number,
        seed=run.meta.seed,
        options={"run": json.dumps({"name": run.name, **metadata})},
        observations=run.stacked(split.state),
        actions=run.stacked(split.action)[:-1],
        rewards=(last & (run.meta.outcome == "success")).astype(float),
        terminations=last & (not cut),
        truncations=last & cut,
        infos=dict(run.columns),
    )
