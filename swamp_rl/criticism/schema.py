"""The published schema of diagnosis.json.

python -m swamp_rl.criticism.schema docs/diagnosis.schema.json
"""

import json
import sys
from pathlib import Path

from swamp_rl.criticism.result import Diagnosis
from swamp_rl.files import write_beside


def schema_text() -> str:
    """JSON Schema (draft 2020-12) of a diagnosis, as the file holds it."""
    schema = Diagnosis.model_json_schema(mode="serialization")
    named = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "diagnosis.json of swamp-rl diagnose",
    }
    return json.dumps(named | {k: v for k, v in schema.items() if k != "title"}, indent=2) + "\n"


def main() -> None:
    """Write the schema to the file named on the command line."""
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        raise SystemExit(__doc__)
    with write_beside(Path(sys.argv[1])) as part:
        part.write_text(schema_text(), encoding="utf-8")


if __name__ == "__main__":
    main()
