"""`python -m benchmarks.attack [PART ...]`: attack the package, print counts; 1 if any is unexplained."""

import argparse
import importlib
import sys
from pathlib import Path

from benchmarks.attack.counts import write_table

PARTS = ("parsers", "faults", "kills", "power", "server")
"""Modules beside this one, each with `attack(asked)`, an iterator of `Count`s."""


def unexplained(part: str, asked: argparse.Namespace) -> int:
    """Carry out one part, print its counts and keep them; how much of it is unexplained."""
    total = 0
    for count in importlib.import_module(f"benchmarks.attack.{part}").attack(asked):
        note = f" ({count.note})" if count.note else ""
        print(f"{part}: {count.what}: {count.tried} tried, {len(count.unexplained)} unexplained{note}")
        for line in count.unexplained:
            print(f"    {line}")
        sys.stdout.flush()
        if asked.keep:
            count.keep(asked.keep)
        total += len(count.unexplained)
    return total


def main() -> int:
    """Carry out the parts that are asked for, all that are there by default."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.attack", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}; all by default")
    parser.add_argument("--quick", action="store_true", help="few attacks, to see that it works")
    parser.add_argument("--count", type=int, help="inputs of each format, places of faults, kills, cuts")
    parser.add_argument("--only", action="append", metavar="NAME", help="a format or command; repeatable")
    parser.add_argument("--findings", metavar="FOLDER", help="where inputs of `parsers` that were found go")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="where the counts go; others are added")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--document", type=Path, metavar="FOLDER", help="only write its counts into the docs; other rows stay"
    )
    asked = parser.parse_args()
    if asked.document:
        write_table(asked.document, PARTS)
        return 0
    for part in asked.parts:
        if part not in PARTS:
            parser.error(f"no part {part!r}; there are {', '.join(PARTS)}")
    total = sum(unexplained(part, asked) for part in asked.parts or PARTS)
    print(f"{total} unexplained in all")
    return int(total > 0)


if __name__ == "__main__":
    sys.exit(main())
