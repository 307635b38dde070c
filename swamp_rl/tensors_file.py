"""Named tensors in the bytes of a safetensors file, and the texts in its header."""

from collections.abc import Callable
from typing import Any

from swamp_rl.json_text import parsed_json

LONGEST = 2**22
"Bytes of the header: a tensor needs some 80, a run of a DAgger about 5,000."


def tensors_in(data: bytes, load: Callable[[bytes], dict[str, Any]]) -> tuple[dict[str, str], dict[str, Any]]:
    """The texts and what `load` of safetensors makes of the tensors; ValueError where they are damaged.

    The bytes are those whose checksum was verified: the file may be another when it is opened once more.
    """
    from safetensors import SafetensorError

    size = int.from_bytes(data[:8], "little")
    if size > LONGEST or len(data) < 8 + size:
        raise ValueError(f"a header of {size} bytes, it has at most {LONGEST} and they are all there")
    header = parsed_json(data[8 : 8 + size])
    try:
        return dict(header.get("__metadata__") or {}), load(data)
    except (SafetensorError, AttributeError, KeyError, TypeError) as error:
        raise ValueError(str(error)) from error
