"""A page in HTML that needs no other file: its style, tables, figures, and numbers as text."""

import html
import math
import re
from collections.abc import Sequence

STYLE = """
:root{--ink:#1c2733;--soft:#5b6874;--line:#dfe4e8;--tint:#f5f7f9}
body{font:16px/1.55 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;color:var(--ink);
max-width:64rem;margin:2.5rem auto;padding:0 1.5rem;background:#fff}
h1{font-size:1.9rem;line-height:1.25;margin:.3rem 0 .8rem}h2{font-size:1.25rem;margin:2.6rem 0 .5rem}
p{max-width:46rem;margin:.5rem 0}.soft{color:var(--soft)}
.badge{display:inline-block;border-radius:1rem;padding:.1rem .8rem;font-size:.85rem;font-weight:600;
color:#fff}
.nothing_wrong{background:#2e7d4f}.cause{background:#1f6fb2}.indistinguishable{background:#b07514}
.unexplained{background:#a13b32}
.cards{display:flex;flex-wrap:wrap;gap:.8rem;margin:1.2rem 0}
.card{background:var(--tint);border:1px solid var(--line);border-radius:.5rem;padding:.6rem 1rem;
min-width:12rem}
.card b{display:block;font-size:1.25rem}.card span{color:var(--soft);font-size:.85rem}
table{border-collapse:collapse;margin:.8rem 0;font-size:.93rem}
th{font-weight:600;border-bottom:2px solid var(--line);color:var(--soft)}
td,th{padding:.3rem 1.1rem .3rem 0;text-align:left;vertical-align:top}td{border-bottom:1px solid var(--line)}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
img{width:100%;height:auto;margin:.4rem 0}summary{cursor:pointer;color:var(--soft)}
.wide{overflow-x:auto}td.t{white-space:nowrap}
@media(max-width:40rem){body{margin:1.2rem auto;padding:0 1rem}h1{font-size:1.5rem}.wide img{min-width:44rem}}
"""


def document(title: str, parts: Sequence[str]) -> str:
    """A whole HTML document; parts: of its body."""
    head = '<meta charset="utf-8"><meta name="viewport" content="width=device-width">'
    head += f"<title>{html.escape(title)}</title><style>{STYLE}</style>"
    return f'<!doctype html><html lang="en"><head>{head}</head><body>{"".join(parts)}</body></html>\n'


def prose(text: str) -> str:
    """A sentence as HTML; what stands between backquotes is code."""
    return re.sub("`([^`]+)`", r"<code>\1</code>", html.escape(text))


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


def plain(value: float) -> str:
    """Three significant digits without zeros at the end."""
    return minus(f"{float(f'{value:.3g}') + 0.0:g}")


def minus(digits: str) -> str:
    """Numbers with the typographic minus sign."""
    return digits.replace("-", "−")


def places_of(value: float, digits: int = 3) -> int:
    """Decimals that show so many digits of a value, five at most."""
    if value == 0.0 or not math.isfinite(value):
        return 0
    return min(max(0, digits - 1 - math.floor(math.log10(abs(value)))), 5)


def rounded(value: float) -> str:
    """Three significant digits, without powers of ten."""
    return f"{value:.{places_of(value)}f}"


def with_error(value: float, error: float) -> str:
    """A number and its standard error, to the second digit of that."""
    places = places_of(error, 2) or places_of(value, 2)
    return f"{value:.{places}f} ± {error:.{places}f} (one standard error)"
