"""The command line of a page on a measured boat."""

import argparse
from pathlib import Path


def source_and_out(text: str | None) -> tuple[Path, Path]:
    """The folder of the measured data and the new folder `--out`; text: what `--help` says."""
    parser = argparse.ArgumentParser(description=text)
    parser.add_argument("source", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    asked = parser.parse_args()
    return asked.source, asked.out
