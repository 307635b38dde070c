"""The diagnosis of one dataset of a fleet, from text to text, for any process of any machine."""

import hashlib
import json
import os
from pathlib import Path

from swamp_rl.experiments.fleet.labels import is_weather, label

from swamp_rl.boat import Boat
from swamp_rl.boat.digest import boat_digest
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.errors import UserError
from swamp_rl.files import os_error
from swamp_rl.json_text import model_in, parsed_json
from swamp_rl.names import YAML
from swamp_rl.one_thread import one_thread
from swamp_rl.ordinary import MOST_JSON, contents
from swamp_rl.runs.describe import is_table

RESULT, INPUT = "diagnosis.json", "fleet_input.json"


@one_thread()
def diagnose_one(job: str) -> str:
    """Diagnose a dataset and note what it was; the job holds `dataset`, `boat`, `out`, `ignore` and `input`.

    The note is in the folder from the first: it is the command's, and no file that came later.
    """
    from swamp_rl.criticism.diagnose import diagnose

    asked = json.loads(job)
    dataset, out = Path(asked["dataset"]), Path(asked["out"])
    try:
        notes = {INPUT: json.dumps(asked["input"], indent=1) + "\n"}
        found = diagnose(dataset, asked["boat"], out, ignore=asked["ignore"], notes=notes)
    except UserError as error:
        return json.dumps({"error": " ".join(str(error).split())})
    return answer_of(found)


def answer_of(found: Diagnosis) -> str:
    """What a worker says of a diagnosis: the verdict, the boat's causes, the weather."""
    every = [label(one) for one in found.causes]
    weather = [one for one in every if is_weather(one)]
    causes = [one for one in every if one not in weather]
    return json.dumps({"verdict": found.verdict, "causes": causes, "weather": weather})


def input_of(dataset: Path, numbers: str, ignore: list[str], version: str) -> dict[str, object]:
    """All that a diagnosis depends on: what is ignored, and the digest of the dataset's files and of the
    boat's `numbers` (`numbers_of`, empty for the dataset's own).
    """
    digest = hashlib.sha256()
    files = [path for path in sorted(dataset.iterdir()) if _is_source(path) and path.is_file()]
    for path in files:
        digest.update(os.fsencode(path.name) + b"\0")
        digest.update(hashlib.sha256(contents(path)).digest())
    digest.update(numbers.encode())
    return {"ignore": sorted(ignore), "files": digest.hexdigest(), "swamp_rl": version}


def numbers_of(boat: Boat) -> str:
    """Digest of all that a diagnosis takes from a boat: its numbers, and their covariance where it has one.

    The same for any spelling of the file's path.
    """
    if boat.covariance is None:
        return boat_digest(boat)
    return boat_digest(boat) + hashlib.sha256(boat.covariance.model_dump_json().encode()).hexdigest()


def _is_source(path: Path) -> bool:
    """Whether a file is one of a dataset that may be read: a run, or a description, by its name."""
    return is_table(path) or path.suffix.lower() in YAML


def is_done(out: Path, given: dict[str, object]) -> bool:
    """Whether a folder holds the whole diagnosis of just that input."""
    try:
        note = parsed_json(contents(out / INPUT, MOST_JSON, follow=False))
        read_diagnosis(out)
    except (UserError, OSError, ValueError):
        return False
    return bool(note == given)


def read_diagnosis(out: Path) -> Diagnosis:
    """The diagnosis in a folder; UserError where it is none."""
    path = out / RESULT
    try:
        return model_in(contents(path, MOST_JSON, follow=False), Diagnosis)
    except OSError as error:
        raise os_error(error, path) from error
    except ValueError as error:
        raise UserError(f"{path}: is not a diagnosis; remove the folder {out.name}") from error
