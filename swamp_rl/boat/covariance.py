"""Joint errors of the numbers of an identified boat."""

from typing import Annotated, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from swamp_rl.boat.magnitude import MOST
from swamp_rl.boat.part import FILLED, FROM_LIST, NOT_NEGATIVE, PRINTED, Part

Correlation = Annotated[float, Field(ge=-1, le=1)]


class Covariance(Part):
    """Errors of fitted numbers, which are larger one by one than together: thrust and mass scale alike."""

    source: Annotated[str, Field(max_length=1000), PRINTED]
    "Runs that the numbers were fitted to."
    numbers: Annotated[tuple[str, ...], FROM_LIST, FILLED, Field(max_length=1000)]
    "Names, as in the report of `identify boat`."
    standard_errors: Annotated[tuple[Annotated[float, NOT_NEGATIVE, Field(le=MOST)], ...], FROM_LIST]
    "Of each, as it is fitted: of a number that keeps its sign, of its logarithm."
    correlation: Annotated[tuple[Annotated[tuple[Correlation, ...], FROM_LIST], ...], FROM_LIST]
    "Of the errors: row i has those with the numbers before number i, the first row none."

    @model_validator(mode="after")
    def _is_a_triangle(self) -> Self:
        count = len(self.numbers)
        if len(set(self.numbers)) < count:
            raise ValueError("numbers: must differ")
        if len(self.standard_errors) != count:
            raise ValueError(f"standard_errors: must be {count}, one of each number")
        if [len(row) for row in self.correlation] != list(range(count)):
            raise ValueError(f"correlation: must be {count} rows of 0, 1, 2 and so on numbers")
        return self

    @property
    def matrix(self) -> NDArray[np.float64]:
        """(n, n) covariance."""
        correlation = np.eye(len(self.numbers))
        for i, row in enumerate(self.correlation):
            correlation[i, :i] = correlation[:i, i] = row
        return np.asarray(correlation * np.outer(self.standard_errors, self.standard_errors))
