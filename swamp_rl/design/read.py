"""Design files: found, read strictly, and refused where they are of another kind of design."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel

from swamp_rl.boat.magnitude import out_of_range
from swamp_rl.clipped import clipped
from swamp_rl.config_kind import refuse_other_kind
from swamp_rl.errors import UserError
from swamp_rl.explain import in_yaml
from swamp_rl.files import find_config, read_yaml, validated

Model = TypeVar("Model", bound=BaseModel)


@contextmanager
def computable(name: str) -> Iterator[None]:
    """UserError for the design of that name where the block leaves the range of floating-point numbers."""
    try:
        yield
    except ArithmeticError as error:
        reason = clipped(f"{type(error).__name__}: {error}", 100)
        raise UserError(
            f"{name}: cannot be computed ({reason}); check the dimensions and their units"
        ) from error


def read_design(name_or_path: str | Path, kind: str, model: type[Model]) -> Model:
    """The design file given by path or, in configs/designs, by bare name, as a `model`.

    kind: what its key `design` must say. UserError names file, key and what is allowed.
    """
    path = find_config("designs", name_or_path)
    data = read_yaml(path)
    refuse_other_kind(path, data, "design")
    data = {"name": path.stem} | data
    if data.get("design") != kind:
        message = f"is {clipped(in_yaml(data['design']))}" if "design" in data else "is missing"
        raise UserError(f"{path}: design: {message}; swamp-rl design {kind} takes files with design: {kind}")
    if faults := list(out_of_range(data)):
        raise UserError("\n".join(f"{path}: {key}: {message}" for key, message in faults))
    return validated(path, model, data)
