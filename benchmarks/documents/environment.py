"""The tables of docs/environment.md: what is declared, and returns of three pilots to compare with.

    python -m benchmarks.documents.environment           # all
    python -m benchmarks.documents.environment --terms   # only the declared tables, in a second

Random actions are uniform in the action space, drawn anew at every step.
"""

import ast
import inspect
import math
import sys
from typing import Any

import numpy as np
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.kernel import CUT, OUTCOMES
from swamp_rl.envs.observation import GATES, LIMIT, OBSERVATION, SENSES, Sense
from swamp_rl.envs.own_terms import Batch
from swamp_rl.envs.reward import REWARD
from swamp_rl.experiments.reports.experiment import rate, table

from benchmarks.markers import DOCS, write_parts
from swamp_rl.evaluation import drive, episode_table, summary
from swamp_rl.evaluation.rollout import Array, Pilot
from swamp_rl.pilots.arrays import HIGHEST, LOWEST
from swamp_rl.pilots.line_of_sight import LineOfSightPilot
from swamp_rl.pilots.scripted import ScriptedPilot

PAGE = DOCS / "environment.md"
LEVELS = ("calm", "standard", "severe")
FIRST, EPISODES = 5_000_000, 1000


class RandomPilot:
    """Uniform actions."""

    senses: tuple[str, ...] = ("north",)

    def __init__(self, seed: int) -> None:
        """seed: of the actions."""
        self._rng = np.random.default_rng(seed)

    def reset(self, n: int) -> None:
        """Nothing is remembered."""

    def keep(self, boats: Array) -> None:
        """Nothing is remembered."""

    def act(self, observation: Array) -> Array:
        """Levers (n, 2)."""
        return self._rng.uniform(LOWEST, HIGHEST, (len(observation), 2))


def senses_table() -> str:
    """What may be observed, as declared; the default ones first."""
    rows = [
        [f"`{sense.name}`", sense.unit, _bounds(sense), sense.meaning, "yes" if i < len(OBSERVATION) else ""]
        for i, sense in enumerate(SENSES)
    ]
    return _left(table(["name", "unit", "bounds", "meaning", "default"], rows))


def _bounds(sense: Sense) -> str:
    if sense.high in (GATES, LIMIT):
        return f"0 to the {sense.high}"
    return f"{sense.low:g} to {sense.high:g}" if math.isfinite(float(sense.high)) else "–"


def reward_table() -> str:
    """Terms of the reward as declared."""
    rows = [
        [
            f"`{term.name}`",
            f"{'−' if term.cost else '+'} {term.equation}",
            f"{term.weight:g}",
            term.unit,
            term.meaning,
        ]
        for term in REWARD
    ]
    return _left(table(["name", "in a step", "default w", "unit of w", "meaning"], rows))


def batch_table() -> str:
    """What a term of one's own is given."""
    docs = _field_docs()
    return _left(table(["field", "what it is"], [[f"`{name}`", docs[name]] for name in docs]))


def outcomes_table() -> str:
    """How an episode may end."""
    meanings = {
        "success": "the gates are passed in their order, each from behind",
        "buoy": "a buoy is touched; it counts before all else",
        "aground": "draught and squat reach the depth of the water; it counts before success",
        "out_of_bounds": "midship is beyond an edge",
        "timeout": "the time limit",
        "diverged": "the simulated motion is not finite or beyond any boat's; the step pays 0",
    }
    rows = [
        [f"`{name}`", "truncated" if OUTCOMES.index(name) in CUT else "terminated", meanings[name]]
        for name in OUTCOMES
        if name in meanings
    ]
    return _left(table(["outcome", "ends as", "when"], rows))


def returns_table(episodes: int = EPISODES) -> str:
    """Mean return and success of three pilots at three levels."""
    pilots: dict[str, Pilot] = {
        "random actions": RandomPilot(0),
        "line-of-sight": LineOfSightPilot(),
        "scripted": ScriptedPilot(0),
    }
    rows = []
    for name, pilot in pilots.items():
        for level in LEVELS:
            found = _tried(pilot, level, episodes)
            low, high = found["return_95"]
            rows.append(
                [f"{name}, {level}", f"{found['mean_return']:.2f} ({low:.2f} to {high:.2f})", rate(found)]
            )
    head = ["pilot, level", "mean return (95 %)", "success [%] (Wilson 95 %)"]
    return f"{table(head, rows)}\n\n{episodes} episodes each, of the seeds from {FIRST:,} on."


def _tried(pilot: Pilot, level: str, episodes: int) -> dict[str, Any]:
    def make(n: int, senses: tuple[str, ...]) -> GatesVectorEnv:
        return GatesVectorEnv(n, disturbances=level, observation=senses)

    rollout = drive(pilot, make, FIRST + np.arange(episodes))
    return summary(episode_table(rollout, make(1, ("north",)).task.boat, 0.1))


def _field_docs() -> dict[str, str]:
    """The fields of `Batch` with the text that stands below each in its source."""
    body = ast.parse(inspect.getsource(Batch)).body[0].body  # type: ignore[attr-defined]
    docs: dict[str, str] = {}
    for node, after in zip(body, [*body[1:], None], strict=True):
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            assert isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
            docs[node.target.id] = str(after.value.value)
    return docs


def _left(text: str) -> str:
    return text.replace("--:", ":--")


def declared() -> dict[str, str]:
    """The tables that need no episodes."""
    return {
        "senses": senses_table(),
        "reward": reward_table(),
        "batch": batch_table(),
        "outcomes": outcomes_table(),
    }


def main() -> None:
    """Write the tables."""
    if sys.argv[1:] not in ([], ["--terms"]):
        raise SystemExit(__doc__)
    write_parts(PAGE, declared())
    if not sys.argv[1:]:
        write_parts(PAGE, {"returns": returns_table()})


if __name__ == "__main__":
    main()
