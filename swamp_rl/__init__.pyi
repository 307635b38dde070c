from swamp_rl import course as course
from swamp_rl import effects as effects
from swamp_rl.api import identify as identify
from swamp_rl.api import simulate as simulate
from swamp_rl.api import trial as trial
from swamp_rl.boat import load_boat as load_boat
from swamp_rl.boat_fit.identify import identify_boat as identify_boat
from swamp_rl.criticism.diagnose import diagnose as diagnose
from swamp_rl.experiments.studies.run import run_experiment as run_experiment
from swamp_rl.experiments.studies.run import train_experiment as train
from swamp_rl.experiments.studies.stored import evaluate_folders as evaluate
from swamp_rl.pilots import load_pilot as load_pilot
from swamp_rl.runs import read_dataset as read_runs

__version__: str
ENVIRONMENTS: dict[str, str]
PUBLIC: dict[str, str]

__all__ = [
    "course",
    "diagnose",
    "effects",
    "evaluate",
    "identify",
    "identify_boat",
    "load_boat",
    "load_pilot",
    "read_runs",
    "run_experiment",
    "simulate",
    "train",
    "trial",
]
