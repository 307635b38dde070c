"""Formats fuzzed, each in a fork of its own: `python -m benchmarks.attack.fuzz KEEP INPUTS SEED FORMAT ...`.

With atheris (libFuzzer, guided by the coverage of this package's loaders) and, every second input, by a small
change of the good file, which gets further into its reader; without atheris by such changes alone. Into a
folder of each format in KEEP go `tally.json` and each finding, one for each place; a line with the exit
status is printed as each ends.
"""

import json
import os
import random
import re
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

HANG = 5.0
"""Seconds of processor time that one input may take."""
GIVEN_UP = 60
"""Seconds after which one that does not end is stopped."""
INTERESTING = b"0123456789-+.eE:,{}[]\"'\n\0\xff !&*#%<>|"
WORD = re.compile(rb"[\w.+-]+")
NUMBERS = b"0 -1 1 0.5 1e308 1e-320 1e999 nan NaN -inf Infinity 9223372036854775808 0x10 1_0 1e3 007"
OTHERS = (
    b"true null ~ [] {} '' [[]] [0] {a:1} off 2024-01-01 ! & * .. ../a /a \\u0000 \\ud800 \xff \x1b[31m =1"
)
WORDS = [*NUMBERS.split(), *OTHERS.split(), b"9" * 90, b"9" * 400, b"a" * 3000, b"[" * 200]
LOADERS = (
    "swamp_rl.files",
    "swamp_rl.yaml_text",
    "swamp_rl.explain",
    "swamp_rl.seal",
    "swamp_rl.arrays_file",
    "swamp_rl.tensors_file",
    "swamp_rl.runs",
    "swamp_rl.logs",
    "swamp_rl.design",
    "swamp_rl.energy.mission",
    "swamp_rl.guidance.path_file",
    "swamp_rl.identification.square_twin",
    "swamp_rl.effects.curve",
    "swamp_rl.sums",
    "swamp_rl.doctor",
    "swamp_rl.link",
    "swamp_rl.experiments.fleet",
    "swamp_rl.experiments.artifacts.result_folders",
    "swamp_rl.experiments.reports.leaderboard",
    "swamp_rl.boat",
    "swamp_rl.course.schema",
    "swamp_rl.effects.entries",
    "swamp_rl.effects.levels",
    "swamp_rl.effects.random_entry",
    "swamp_rl.effects.correlated",
    "swamp_rl.manoeuvres.plan",
    "swamp_rl.pilots.description",
    "swamp_rl.pilots.store",
    "swamp_rl.pilots.checkpoint",
    "swamp_rl.pilots.dagger_checkpoint",
    "swamp_rl.export.onnx_pilot",
    "swamp_rl.teleop.messages",
    "swamp_rl.teleop.journal",
    "swamp_rl.experiments.config.load",
    "swamp_rl.experiments.training.curves",
    "swamp_rl.experiments.sweep.schema",
    "swamp_rl.experiments.sweep.store",
)
"""Packages and modules whose coverage guides; what is compiled cannot be instrumented."""
SOURCES = {"swamp_rl": "swamp_rl", "experiments": "swamp_rl.experiments", "envs": "swamp_rl.envs"}
"""Folders of the repository and the packages that they are."""


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

    @classmethod
    def read(cls, out: Path, name: str) -> "Tally":
        """What `write` wrote; an empty one where nothing was written."""
        path = out / "tally.json"
        return cls(**json.loads(path.read_text())) if path.is_file() else cls(name, "no input")


class Hung(BaseException):
    """Raised by the alarm in an input that does not end."""


def main(keep: Path, inputs: int, seed: int, names: Sequence[str]) -> None:
    """Fuzz formats, one after another."""
    warnings.simplefilter("ignore")
    try:
        import atheris
    except ImportError:
        atheris = None
    with _guided(atheris):
        from benchmarks.attack import formats  # noqa: F401
        from benchmarks.attack.samples import parse_once
    parse_once()
    for name in names:
        child = os.fork()
        if child == 0:
            try:
                out = folder_of(keep, name)
                with (out / "log").open("w") as log:
                    for stream in (1, 2):
                        os.dup2(log.fileno(), stream)
                fuzz(name, out, inputs, seed, atheris)
            except BaseException:
                traceback.print_exc()
            finally:
                sys.stderr.flush()
                os._exit(70)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        print(f"{code} {name}", flush=True)


def folder_of(keep: Path, name: str) -> Path:
    """The folder of a format in KEEP."""
    return keep / name.replace(" ", "-").replace("/", "-")


def _guided(atheris: Any) -> AbstractContextManager[Any]:
    """While it holds, what is imported of LOADERS is instrumented."""
    if atheris is None:
        return nullcontext()
    names = set()
    for folder, package in SOURCES.items():
        root = Path(__file__).parents[2] / folder
        for path in root.rglob("*.py"):
            parts = path.relative_to(root).with_suffix("").parts
            names.add(".".join((package, *(part for part in parts if part != "__init__"))))
    others = [name for name in names if not any(f"{name}.".startswith(f"{one}.") for one in LOADERS)]
    return atheris.instrument_imports(include=["swamp_rl"], exclude=others, enable_loader_override=False)


def fuzz(name: str, out: Path, inputs: int, seed: int, atheris: Any) -> None:
    """Fuzz one format; the process ends with it."""
    place = Path(tempfile.mkdtemp(prefix="swamp-rl-attack-"))
    with _guided(atheris):  # readers import the most when they first read
        from benchmarks.attack.formats import FORMATS, outcome

        format = FORMATS[name]
        path = format.make(place)
        good = path.read_bytes()
        assert outcome(format, path, good) == "accepted", "the good file is refused"
    tally = Tally(name, "mutations" if atheris is None else "atheris")

    def alarmed(*_: Any) -> None:
        raise Hung

    signal.signal(signal.SIGALRM, alarmed)

    def one(data: bytes) -> None:
        begun = time.process_time()  # other work on the machine is not the loader's
        signal.alarm(GIVEN_UP)
        try:
            met = outcome(format, path, data)
            tally.accepted += met == "accepted"
            tally.refused += met == "refused"
        except (Exception, Hung) as error:
            tally.find(_place(error), data, out)
        finally:
            signal.alarm(0)
        took = time.process_time() - begun
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
        f"-artifact_prefix={out}/",
        f"-max_len={max(20000, 2 * len(good))}",
        "-rss_limit_mb=0",
        "-verbosity=0",
        "-len_control=0",
        "-print_final_stats=0",
    ]

    def either(data: bytes, longest: int, number: int) -> bytes:
        chance = random.Random(number)
        return mutated(good, chance)[:longest] if number % 2 else atheris.Mutate(data, longest)

    atheris.Setup([sys.argv[0], *options, str(corpus)], one, custom_mutator=either)
    atheris.Fuzz()


def mutated(data: bytes, chance: random.Random) -> bytes:
    """The bytes with some flipped, replaced, repeated elsewhere or left out."""
    found = bytearray(data)
    for _ in range(chance.choice((1, 1, 2, 5, 20))):
        at, kind = chance.randrange(len(found) + 1), chance.randrange(6)
        if kind > 3 and (word := WORD.search(found, at)):
            found[slice(*word.span())] = chance.choice(WORDS)
        elif kind == 0 and at < len(found):
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
    main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4:])
