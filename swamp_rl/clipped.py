"""Words of a stranger's file, short enough to be told in one line."""

LONGEST = 80


def clipped(word: object, longest: int = LONGEST) -> str:
    """The word's text, its middle left out where it has more than `longest` characters."""
    text = str(word)
    if len(text) <= longest:
        return text
    half = (longest - 3) // 2
    return f"{text[:half]}...{text[-half:]}"
