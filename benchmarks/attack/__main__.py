"""`python -m benchmarks.attack [PART ...]`: attack the package and print the counts; 1 if any is found."""

import argparse
import importlib.util
import sys

PARTS = ("parsers", "faults", "kills", "power", "server")
"""Modules beside this one; those that are there have `attack(asked) -> int`, the number of findings."""


def main() -> int:
    """Carry out the parts that are asked for, all that are there by default."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.attack", description=__doc__)
    there = [part for part in PARTS if importlib.util.find_spec(f"benchmarks.attack.{part}")]
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(there)}; all by default")
    parser.add_argument("--quick", action="store_true", help="few inputs, to see that it works")
    parser.add_argument("--inputs", type=int, help="for each format, by default 10,000")
    parser.add_argument("--seconds", type=float, help="for each format at most")
    parser.add_argument("--only", action="append", metavar="FORMAT", help="may be repeated")
    parser.add_argument("--findings", metavar="FOLDER", help="where the inputs that were found are kept")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    for part in asked.parts:
        if part not in there:
            parser.error(f"no part {part!r}; there are {', '.join(there)}")
    found = 0
    for part in asked.parts or there:
        found += importlib.import_module(f"benchmarks.attack.{part}").attack(asked)
    print(f"{found} findings in all")
    return int(found > 0)


if __name__ == "__main__":
    sys.exit(main())
