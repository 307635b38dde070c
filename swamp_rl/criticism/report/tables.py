"""Tables and figures in HTML."""

import html
from collections.abc import Sequence


def image(data: str, title: str) -> str:
    """A figure held in the page; data: PNG in base64."""
    return f'<div class="wide"><img alt="{html.escape(title)}" src="data:image/png;base64,{data}"></div>'


def table(
    heads: Sequence[str],
    rows: Sequence[Sequence[str]],
    numbers: Sequence[int] = (),
    raw: bool = False,
    unbroken: Sequence[int] = (),
) -> str:
    """An HTML table; columns `numbers` are aligned right, they and `unbroken` not broken; raw: HTML cells."""
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
