"""Tables of docs/import.md: the default mappings of binary logs, and the functions of expressions.

python -m benchmarks.documents.log_defaults
"""

from benchmarks.markers import DOCS, write_parts
from swamp_rl.logs.defaults import SOURCES
from swamp_rl.logs.expression import FUNCTIONS, TIMED

NAMES = {"dataflash": "ArduPilot", "ulog": "PX4", "rosbag": "ROS"}


def defaults_table() -> str:
    """A row for each message that gives columns, in the order of preference."""
    rows = ["| log | of a run | message | mapping |", "|:--|:--|:--|:--|"]
    for kind, sources in SOURCES.items():
        for source in sources:
            output = ", ".join(
                f"`{name}={text.replace('TABLE.', '')}`" for name, text in source.columns.items()
            )
            rows.append(f"| {NAMES[kind]} | {source.gives} | `{source.message}` | {output} |")
    return "\n".join(rows)


def functions_line() -> str:
    """The functions with their numbers of arguments."""
    known = {name: count for name, (count, _) in FUNCTIONS.items()} | dict.fromkeys(TIMED, 1)
    return ", ".join(f"`{name}` ({count})" for name, count in known.items())


def main() -> None:
    parts = {"log defaults": defaults_table(), "functions": functions_line()}
    write_parts(DOCS / "import.md", {name: f"\n{body}\n" for name, body in parts.items()})


if __name__ == "__main__":
    main()
