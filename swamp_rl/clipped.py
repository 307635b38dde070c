"""Words of a stranger, short and printable enough to be told in one line."""

LONGEST = 80


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
