"""Tables of the report."""

import html
from collections.abc import Sequence


def table(
    heads: Sequence[str],
    rows: Sequence[Sequence[str]],
    numbers: Sequence[int] = (),
    raw: bool = False,
    unbroken: Sequence[int] = (),
) -> str:
    """An HTML table, the columns `numbers` aligned right, those and `unbroken` on one line; raw: cells are
    HTML already.
    """
    if not rows:
        return "<p>None.</p>"
    kinds = [
        ' class="n"' if i in numbers else ' class="t"' if i in unbroken else "" for i in range(len(heads))
    ]
    top = "".join(f"<th{kind}>{html.escape(head)}</th>" for kind, head in zip(kinds, heads, strict=True))
    body = "".join(
        "<tr>"
        + "".join(
            f"<td{kind}>{cell if raw else html.escape(cell)}</td>"
            for kind, cell in zip(kinds, row, strict=True)
        )
        + "</tr>"
        for row in rows
    )
    return f'<div class="wide"><table><tr>{top}</tr>{body}</table></div>'
