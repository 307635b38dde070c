"""The published schemas of diagnosis.json: of measured runs, and of printed figures.

python -m swamp_rl.criticism.schema docs/diagnosis.schema.json docs/figures_diagnosis.schema.json
"""

import sys
from pathlib import Path

from pydantic import BaseModel

from swamp_rl import json_text
from swamp_rl.criticism.figures.result import FiguresDiagnosis
from swamp_rl.criticism.result import Diagnosis
from swamp_rl.files import write_text


def schema_text(model: type[BaseModel] = Diagnosis) -> str:
    """JSON Schema (draft 2020-12) of a diagnosis, as the file holds it."""
    of = "" if model is Diagnosis else " on printed figures"
    return json_text.schema_text(model, f"diagnosis.json of swamp-rl diagnose{of}")


def main() -> None:
    """Write both schemas to the files named on the command line."""
    if len(sys.argv) != 3 or sys.argv[1].startswith("-"):
        raise SystemExit(__doc__)
    models: list[type[BaseModel]] = [Diagnosis, FiguresDiagnosis]
    for name, model in zip(sys.argv[1:], models, strict=True):
        write_text(Path(name), schema_text(model))


if __name__ == "__main__":
    main()
