"""One thread for the linear algebra, whose sums have another order on two."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def one_thread(torch: bool = False) -> Iterator[None]:
    """NumPy's and SciPy's linear algebra within the block, or the function decorated; with `torch` that of
    PyTorch as well, which is imported.

    OpenBLAS divides a product by the number of threads, and each part's edge is summed in an order of its
    own: the last bits would depend on the number of processors. Matrices as small as ours are also slower
    when divided. The compiled steps of boats, which no thread divides, still use every processor.
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="blas"):
        if not torch:
            yield
            return
        import torch as library

        before = library.get_num_threads()
        library.set_num_threads(1)
        try:
            yield
        finally:
            library.set_num_threads(before)


def threads() -> dict[str, int]:
    """How many threads there are now for linear algebra and, once they are imported, for PyTorch and for the
    compiled steps of boats."""
    from threadpoolctl import threadpool_info

    pools = [pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"]
    found = {"linear_algebra": max(pools, default=1)}
    library: Any = sys.modules.get("torch")
    if library is not None:
        found["torch"] = library.get_num_threads()
    library = sys.modules.get("numba")
    if library is not None:
        found["compiled_steps"] = library.get_num_threads()
    return found
