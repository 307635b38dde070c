"""One format fuzzed in a process of its own: `python -m benchmarks.attack.fuzz FORMAT OUT INPUTS SEED`.

With atheris (libFuzzer, guided by the coverage of this package's loaders), or, where that is not installed,
by plain mutations of the good file. Into the folder OUT go `tally.json` and each finding, one for each place.
"""

import json
import os
import random
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

HANG = 5.0
"""Seconds that one input may take."""
GIVEN_UP = 60
"""Seconds after which one that does not end is stopped."""
INTERESTING = b"0123456789-+.eE:,{}[]\"'\n\0\xff !&*#%<>|"
LOADERS = (
    "swamp_rl.files",
    "swamp_rl.yaml_text",
    "swamp_rl.explain",
    "swamp_rl.seal",
    "swamp_rl.arrays_file",
    "swamp_rl.runs",
    "swamp_rl.boat.load",
    "swamp_rl.boat.merge",
    "swamp_rl.boat.resolve",
    "swamp_rl.boat.schema",
    "swamp_rl.course.schema",
    "swamp_rl.effects.entries",
    "swamp_rl.effects.levels",
    "swamp_rl.effects.random_entry",
    "swamp_rl.effects.correlated",
    "swamp_rl.manoeuvres.plan",
    "swamp_rl.pilots.description",
    "swamp_rl.pilots.store",
    "swamp_rl.pilots.dagger_checkpoint",
    "swamp_rl.export.onnx_pilot",
    "swamp_rl.teleop.messages",
    "swamp_rl.teleop.journal",
    "swamp_rl.experiments.config.load",
    "swamp_rl.experiments.curves",
    "swamp_rl.experiments.sweep.schema",
    "swamp_rl.experiments.sweep.store",
)
"""Modules whose coverage guides; compiled functions cannot be instrumented."""


@dataclass
class Tally:
    """What has come out so far; findings by the error and the line of this package that it left by."""

    format: str
    engine: str
    inputs: int = 0
    accepted: int = 0
    refused: int = 0
    slowest_s: float = 0.0
    peak_gb: float = 0.0
    findings: dict[str, str] = field(default_factory=dict)

    def find(self, what: str, data: bytes, out: Path) -> None:
        """Keep the first input that was found to do this."""
        if what not in self.findings:
            name = f"{len(self.findings):03d}.input"
            (out / name).write_bytes(data)
            self.findings[what] = name

    def write(self, out: Path) -> None:
        """Into `tally.json`."""
        self.peak_gb = round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20, 3)
        (out / "tally.json").write_text(json.dumps(asdict(self), indent=1))


class Hung(BaseException):
    """Raised by the alarm in an input that does not end."""


def main(name: str, out: Path, inputs: int, seed: int) -> None:
    """Fuzz one format."""
    warnings.simplefilter("ignore")
    try:
        import atheris
    except ImportError:
        atheris = None
    if atheris is None:
        from benchmarks.attack.formats import FORMATS, outcome
    else:
        with atheris.instrument_imports(include=list(LOADERS), enable_loader_override=False):
            from benchmarks.attack.formats import FORMATS, outcome
    format = FORMATS[name]
    place = Path(tempfile.mkdtemp(prefix="swamp-rl-attack-"))
    path = format.make(place)
    good = path.read_bytes()
    assert outcome(format, path, good) == "accepted", "the good file is refused"
    tally = Tally(name, "mutations" if atheris is None else "atheris")

    def alarmed(*_: Any) -> None:
        raise Hung

    signal.signal(signal.SIGALRM, alarmed)

    def one(data: bytes) -> None:
        begun = time.perf_counter()
        signal.alarm(GIVEN_UP)
        try:
            met = outcome(format, path, data)
            tally.accepted += met == "accepted"
            tally.refused += met == "refused"
        except (Exception, Hung) as error:
            tally.find(_place(error), data, out)
        finally:
            signal.alarm(0)
        took = time.perf_counter() - begun
        tally.slowest_s = max(tally.slowest_s, round(took, 3))
        if took > HANG:
            tally.find(f"took {took:.0f} s", data, out)
        tally.inputs += 1
        if tally.inputs >= inputs or tally.inputs % 50 == 0:
            tally.write(out)
        if tally.inputs >= inputs:
            _remove(place)
            os._exit(0)  # libFuzzer does not come back

    if atheris is None:
        chance = random.Random(seed)
        while True:
            one(mutated(good, chance))
    corpus = place / "corpus"
    corpus.mkdir()
    (corpus / "good").write_bytes(good)
    options = [
        f"-seed={seed}",
        "-max_len=20000",
        "-rss_limit_mb=0",
        "-verbosity=0",
        "-len_control=0",
        "-print_final_stats=0",
    ]
    atheris.Setup([sys.argv[0], *options, str(corpus)], one)
    atheris.Fuzz()


def mutated(data: bytes, chance: random.Random) -> bytes:
    """The bytes with some flipped, replaced, repeated elsewhere or left out."""
    found = bytearray(data)
    for _ in range(chance.choice((1, 1, 2, 5, 20))):
        at, kind = chance.randrange(len(found) + 1), chance.randrange(4)
        if kind == 0 and at < len(found):
            found[at] ^= 1 << chance.randrange(8)
        elif kind == 1 and at < len(found):
            found[at] = chance.choice(INTERESTING)
        elif kind == 2 and data:
            first = chance.randrange(len(data))
            found[at:at] = data[first : first + chance.randrange(40)]
        else:
            del found[at : at + chance.randrange(20)]
    return bytes(found)


def _place(error: BaseException) -> str:
    """The error's type and the last line of this package in its traceback."""
    ours = [
        frame for frame in traceback.extract_tb(error.__traceback__) if "site-packages" not in frame.filename
    ]
    last = ours[-1] if ours else None
    where = f" at {Path(last.filename).name}:{last.lineno}" if last else ""
    return f"{type(error).__name__}{where}: {' '.join(str(error).split())[:120]}"


def _remove(place: Path) -> None:
    import shutil

    shutil.rmtree(place, ignore_errors=True)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]))
