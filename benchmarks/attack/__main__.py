"""`python -m benchmarks.attack [PART ...]`: attack the package and print the counts; 1 if any is found."""

import argparse
import importlib
import sys

PARTS = ("parsers", "faults", "kills", "power", "server")
"""Modules beside this one. `parsers` has `attack(asked) -> int`, the number of findings; the others have
`run(quick) -> list`, for each kind of attack what was tried, how often, and what came of it unexplained."""


def findings(part: str, asked: argparse.Namespace) -> int:
    """Carry out one part and print its counts; how many findings there were."""
    module = importlib.import_module(f"benchmarks.attack.{part}")
    if part == "parsers":
        return int(module.attack(asked))
    counts = module.run(asked.quick)
    for count in counts:
        print(f"{part}: {count['what']}: {count['tried']} tried, {len(count['unexplained'])} unexplained")
        for line in count["unexplained"]:
            print(f"    {line}")
    return sum(len(count["unexplained"]) for count in counts)


def main() -> int:
    """Carry out the parts that are asked for, all that are there by default."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.attack", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}; all by default")
    parser.add_argument("--quick", action="store_true", help="few inputs, to see that it works")
    parser.add_argument("--inputs", type=int, help="for each format, by default 10,000")
    parser.add_argument("--seconds", type=float, help="for each format at most")
    parser.add_argument("--only", action="append", metavar="FORMAT", help="may be repeated")
    parser.add_argument("--findings", metavar="FOLDER", help="where the inputs that were found are kept")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    for part in asked.parts:
        if part not in PARTS:
            parser.error(f"no part {part!r}; there are {', '.join(PARTS)}")
    found = sum(findings(part, asked) for part in asked.parts or PARTS)
    print(f"{found} findings in all")
    return int(found > 0)


if __name__ == "__main__":
    sys.exit(main())
