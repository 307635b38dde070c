"""Sweeps and a fleet on a Ray cluster of two nodes on this machine, in a process that a test can end.

    python -m tests.support.sweep_on_ray FOLDER

writes into FOLDER the sweeps' results: `killed.json` (its second node is killed half-way), `search.json` and
the folder `file` of a sweep that is read from FOLDER/sweep.yaml; and into `fleet` that of the datasets in
FOLDER/datasets, by two nodes.
"""

import json
import sys
import threading
import time
from pathlib import Path
from typing import Any

from ray.cluster_utils import Cluster
from swamp_rl.experiments.fleet import diagnose_fleet
from swamp_rl.experiments.sweep.report import results
from swamp_rl.experiments.sweep.run import carry_on, run_sweep
from swamp_rl.experiments.sweep.schema import Sweep
from swamp_rl.experiments.sweep.store import opened

from swamp_rl.workers.cluster import RayPool
from tests.support.fleets import pretend
from tests.support.sweeps import DRAWN, formula, stuck_on_the_doomed_node, sweep_of

NODE = {
    "num_cpus": 1,
    "object_store_memory": 80_000_000,
    "include_dashboard": False,
    "node_ip_address": "127.0.0.1",
}


def carried_out(folder: Path, name: str, sweep: Sweep, pool: Any, job: Any = json.dumps) -> None:
    """Write the results of a sweep as NAME.json."""
    with opened(folder / name, {}) as store:
        carry_on(sweep, store, pool, job, lambda trial, total: None)
        found = results(sweep, [], store.trials())
    (folder / f"{name}.json").write_text(json.dumps(found))


def killed(folder: Path, cluster: Any) -> None:
    """The second node dies as soon as a trial is at work on it."""
    node = cluster.add_node(**NODE)
    note = folder / "at work on the second node"

    def kill_once_it_works() -> None:
        while not note.exists():
            time.sleep(0.05)
        cluster.remove_node(node, allow_graceful=False)

    def job(values: dict[str, Any]) -> str:
        return json.dumps({**values, "doomed": node.node_id, "note": str(note)})

    with RayPool(stuck_on_the_doomed_node, cluster.address) as pool:
        if pool.size != 2:
            raise RuntimeError(f"the cluster has {pool.size} workers and not two")
        threading.Thread(target=kill_once_it_works, daemon=True).start()
        carried_out(folder, "killed", sweep_of(retries=1), pool, job)


def fleet(folder: Path, cluster: Any) -> None:
    """Pretended diagnoses by both nodes."""
    cluster.add_node(**NODE)
    with RayPool(pretend, cluster.address) as pool:
        if pool.size < 2:  # a node that was killed may be counted for a while
            raise RuntimeError(f"the cluster has {pool.size} workers and not two")
        diagnose_fleet(sorted((folder / "datasets").iterdir()), folder / "fleet", pool=pool)


def main() -> None:
    """All four, on one cluster."""
    folder = Path(sys.argv[1])
    cluster = Cluster(initialize_head=True, head_node_args=NODE)
    try:
        killed(folder, cluster)
        with RayPool(formula, cluster.address) as pool:
            carried_out(folder, "search", sweep_of(**DRAWN), pool)
        run_sweep(folder / "sweep.yaml", out=folder / "file", ray=cluster.address)
        fleet(folder, cluster)
    finally:
        cluster.shutdown()


if __name__ == "__main__":
    main()
