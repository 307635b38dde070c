"""Untrusted text, short and printable enough for one line of a message."""

import re

LONGEST = 80
ACTS = "\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069"
"""Ranges of a regular expression: what a terminal acts on but tab and line end, or what turns text round."""


def clipped(word: object, longest: int = LONGEST) -> str:
    """The word's text, `printable`, its middle left out where it has more than `longest` characters."""
    text = str(word)
    if len(text) > longest:
        half = (longest - 3) // 2
        text = f"{text[:half]}...{text[-half:]}"
    return printable(text)


def printable(text: str) -> str:
    """The text with a space for each letter that a terminal or a log would act on."""
    return "".join(letter if letter.isprintable() else " " for letter in text)


def in_markdown(text: str) -> str:
    """The text in one line that Markdown shows letter for letter: no link, image, element or cell."""
    return re.sub(r"([\\`*<>|\[\]])", r"\\\1", printable(" ".join(text.split())))
