"""Options of the programs that draw cases by their number."""

import argparse

import numpy as np


def add_numbers(parser: argparse.ArgumentParser, cases: int, first: int = 0) -> None:
    """Which cases, by their numbers, and for how long."""
    parser.add_argument("--cases", type=int, default=cases)
    parser.add_argument("--first", type=int, default=first, help="number of the first one")
    parser.add_argument("--minutes", type=float, default=np.inf, help="after which no case is begun")


def add_evidence(parser: argparse.ArgumentParser) -> None:
    """Which cases of level P, by their evidence."""
    parser.add_argument(
        "--evidence",
        type=float,
        nargs=2,
        default=(0.0, np.inf),
        metavar=("FROM", "TO"),
        help="only those cases of level P whose effect has so many standard errors of evidence",
    )
