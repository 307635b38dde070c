"""A run of the data and the learned pilots in its episode: one start, one weather."""

from collections.abc import Mapping

from swamp_rl.experiments.artifacts.flown import flown
from swamp_rl.experiments.config.scene import Scene

from swamp_rl.pilots.pilot import Pilot
from swamp_rl.runs import Dataset, Run

Race = dict[str, Run]
"""A run by its driver: the data's source first, then the learned pilots."""


def fly_race(scene: Scene, dataset: Dataset, pilots: Mapping[str, Pilot]) -> Race:
    """The successful run of middling duration, and every learned pilot from its start and in its weather.

    Where the run tells no weather, as a measured one, the pilots meet none.
    """
    good = sorted(dataset.successful, key=lambda run: run.duration)
    shown = good[len(good) // 2]
    learned = [name for name, plan in scene.experiment.pilots.items() if plan.kind != "scripted"]
    step = scene.experiment.step
    flights = {name: flown(pilots[name], name, shown, scene.boat, scene.course, step) for name in learned}
    return {dataset.meta.source: shown} | {
        name: Run(f"{name}-race", run.columns, run.meta) for name, run in flights.items()
    }
