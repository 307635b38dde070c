"""The reference of the Python interface: directives of Sphinx's autodoc for the public names and modules."""

import importlib

import swamp_rl
from swamp_rl.boat.part import Part

MODULES = (
    "swamp_rl.boat",
    "swamp_rl.effects",
    "swamp_rl.course",
    "swamp_rl.runs",
    "swamp_rl.simulator",
    "swamp_rl.envs.single",
    "swamp_rl.envs.batched",
    "swamp_rl.envs.sb3",
    "swamp_rl.envs.observation",
    "swamp_rl.envs.reward",
    "swamp_rl.pilots",
    "swamp_rl.evaluation",
    "swamp_rl.export",
    "swamp_rl.allocation",
    "swamp_rl.design",
    "swamp_rl.energy",
    "swamp_rl.link",
    "swamp_rl.criticism.model.trial_limits",
    "swamp_rl.errors",
)
TYPES = (
    "swamp_rl.manoeuvres.analysis.figure.Result",
    "swamp_rl.manoeuvres.analysis.figure.Figure",
    "swamp_rl.api.Identified",
    "swamp_rl.boat_fit.result.Identification",
    "swamp_rl.effects.curve.Curve",
    "swamp_rl.criticism.result.Diagnosis",
    "swamp_rl.criticism.result.Cause",
    "swamp_rl.runs.dataset.Inspection",
    "swamp_rl.pilots.description.FittedOn",
    "swamp_rl.pilots.description.Made",
    "swamp_rl.envs.task.TaskArguments",
    "swamp_rl.envs.own_terms.Batch",
    "swamp_rl.envs.own_terms.OwnTerm",
    "swamp_rl.evaluation.rollout.Pilot",
    "swamp_rl.evaluation.rollout.Boats",
    "swamp_rl.evaluation.rollout.Supply",
    "swamp_rl.envs.supply.Supply",
    "swamp_rl.envs.task.Task",
)
"""Classes that these functions and modules take or return and do not name themselves."""

HIDDEN = ":exclude-members: model_config"


def public_names() -> str:
    """Each function of `swamp_rl` itself, then the classes of TYPES."""
    functions = [name for name, place in swamp_rl.PUBLIC.items() if ":" in place]
    parts = ["## Functions\n", *(_rst(f".. autofunction:: swamp_rl.{name}") for name in functions)]
    parts += ["## What they take and return\n"]
    parts += [_rst(f".. autoclass:: {name}\n   :members:\n   {HIDDEN}") for name in TYPES]
    return "\n".join(parts)


def modules() -> str:
    """A section for each module of MODULES."""
    parts = []
    for name in MODULES:
        inside = importlib.import_module(name)
        members = [":members:", *([":imported-members:"] if hasattr(inside, "__all__") else [])]
        keys = [key for one in vars(inside).values() if _is_part(one) for key in one.model_fields]
        members += [", ".join([HIDDEN, *keys])]
        parts += [f"## {name}\n", _rst("\n   ".join([f".. automodule:: {name}", *members]))]
    return "\n".join(parts)


def _is_part(thing: object) -> bool:
    """A section of a boat file, whose keys are in the file's own reference."""
    return isinstance(thing, type) and issubclass(thing, Part)


def _rst(directive: str) -> str:
    return f"```{{eval-rst}}\n{directive}\n```\n"
