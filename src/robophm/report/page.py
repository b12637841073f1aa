"""A report page: one HTML file, no script, nothing loaded from anywhere, fit to be printed.

>>> section("Parts", table_html(["part", "rate"], [["motor", 8e-06]]))[:18]
'<section><h2>Parts'
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from robophm.report.markup import Html, element, escape
from robophm.report.style import FONT, MARKS, Tone, palette
from robophm.report.words import number_text

_POLICY = "default-src 'none'; style-src 'unsafe-inline'"
_STYLE = (
    palette(":root")
    + f"""
*{{box-sizing:border-box}}
body{{margin:0;background:var(--paper);color:var(--ink);font:15px/1.5 {FONT}}}
"""
    + """
main{max-width:1140px;margin:0 auto;padding:28px clamp(14px,4vw,48px) 64px}
h1{font-size:1.75rem;line-height:1.2;margin:0 0 .6rem}
h2{font-size:1.2rem;margin:2.4rem 0 .8rem;padding-bottom:.3rem;border-bottom:1px solid var(--edge)}
p{max-width:75ch;margin:.5rem 0}
svg{max-width:100%;height:auto}
figure{margin:1rem 0}
figcaption,caption,.tile dt,.tile .note{color:var(--quiet);font-size:.82rem}
.scroll{overflow-x:auto}
.tiles,.side{display:grid;gap:14px;margin:1rem 0}
.tiles{grid-template-columns:repeat(auto-fit,minmax(min(230px,100%),1fr))}
.side{grid-template-columns:repeat(auto-fit,minmax(min(380px,100%),1fr));gap:20px 28px}
.side figure{margin:0}
.tile{background:var(--card);border:1px solid var(--edge);border-left:4px solid;border-radius:6px;
 padding:12px 16px}
.tile h3{display:flex;justify-content:space-between;align-items:center;gap:8px;margin:0 0 .3rem;
 font-size:.9rem; font-weight:600;color:var(--quiet)}
.tile h3 span{display:flex;align-items:center;gap:5px;font-size:.75rem;color:var(--ink)}
.tile svg{flex:none}
.tile dl{display:grid;grid-template-columns:auto 1fr;gap:0 10px;align-items:baseline;margin:0}
.tile dd,.tile .value{margin:0;font-size:1.05rem;font-weight:600;line-height:1.5;
 font-variant-numeric:tabular-nums}
.tile .note{margin:.2rem 0 0}
table{border-collapse:collapse;width:100%;font-size:.9rem;font-variant-numeric:tabular-nums}
caption{text-align:left;padding-bottom:.4rem}
th,td{padding:5px 12px;text-align:left;border-bottom:1px solid var(--edge);vertical-align:baseline}
thead th{border-bottom:2px solid var(--line);white-space:nowrap}
tbody th{font-weight:500}
tbody tr:nth-child(even){background:var(--shade)}
.number{text-align:right;white-space:nowrap}
@media screen and (max-width:700px){.diagram svg{max-width:none}
 caption span{display:block;position:sticky;left:0;max-width:calc(100vw - 28px)}}
@page{margin:14mm;@bottom-right{content:counter(page) " / " counter(pages);font-size:8pt}}
.tile h3{bookmark-level:none}
@media print{main{max-width:none;padding:0}body{font-size:10.5pt}
 table{font-size:8.5pt}th,td{padding:3px 6px}thead th{white-space:normal}tbody th{overflow-wrap:anywhere}
 thead{display:table-header-group}
 h2{break-after:avoid}figure,.tile,tr{break-inside:avoid}.scroll{overflow:visible}
 .tiles,.side{grid-template-columns:1fr 1fr}
 *{print-color-adjust:exact;-webkit-print-color-adjust:exact}}
"""
    + "".join(f".tile.{tone}{{border-left-color:var(--{tone})}}.{tone} .tone{{fill:var(--{tone})}}" for tone in MARKS)
)


def page(title: str, sections: Iterable[str]) -> Html:
    """A whole HTML document; any section that is not ``Html`` becomes a paragraph of text."""
    return Html(
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        f"{element('main', element('h1', title), *_body(sections))}\n</body>\n</html>\n"
    )


def section(title: str, *body: str) -> Html:
    """A heading and what is under it; text that is not ``Html`` becomes a paragraph."""
    return element("section", element("h2", title), *_body(body))


def tile(title: str, value: str | Mapping[str, str], note: str = "", tone: Tone | None = "ok") -> Html:
    """A figure to be read at a glance, or several as {"nominal": "…", "sensor-based": "…"}.

    Without a tone nothing says what would be too low.
    """
    if tone:
        symbol = element("svg", element("path", class_="tone", d=MARKS[tone].path), width=10, height=10)
        state = element("span", symbol, MARKS[tone].word)
    else:
        state = element("span", "no limits set")
    if isinstance(value, str):
        figures = element("p", value, class_="value")
    else:
        pairs = [part for name, says in value.items() for part in (element("dt", name), element("dd", says))]
        figures = element("dl", *pairs)
    noted = [element("p", note, class_="note")] if note else []
    return element("div", element("h3", title, state), figures, *noted, class_=f"tile {tone or ''}".rstrip())


def tiles(*each: Html) -> Html:
    """A row of tiles that wraps."""
    return element("div", *_body(each), class_="tiles")


def side_by_side(*each: Html) -> Html:
    """Figures beside each other where there is room, else below."""
    return element("div", *_body(each), class_="side")


def figure(svg: Html, caption: str = "", diagram: bool = False) -> Html:
    """A drawing with its caption; a ``diagram`` scrolls on a small screen rather than become unreadable."""
    drawing = element("div", svg, class_="diagram scroll", tabindex="0") if diagram else svg
    return element("figure", drawing, *([element("figcaption", caption)] if caption else []))


def table_html(columns: Sequence[str], rows: Iterable[Sequence[object]], caption: str = "", align: str = "") -> Html:
    """A table whose first column names its rows; None reads "–", numbers have 4 significant digits.

    ``align`` has "l" or "r" for each column; without it, columns of numbers stand right.
    """
    body = [list(row) for row in rows]
    if not align:
        cells = [[row[i] for row in body if row[i] is not None] for i in range(len(columns))]
        align = "".join("r" if column and all(map(_is_number, column)) else "l" for column in cells)
    css = ["number" if side == "r" else "" for side in align]
    head = [element("th", name, scope="col", class_=css[i]) for i, name in enumerate(columns)]
    lines = [
        element("tr", element("th", _cell(row[0]), scope="row", class_=css[0]),
                *(element("td", _cell(value), class_=css[i]) for i, value in enumerate(row[1:], 1)))
        for row in body
    ]  # fmt: skip
    parts = [element("caption", element("span", caption))] if caption else []
    parts += [element("thead", element("tr", *head)), element("tbody", *_body(lines))]
    return element("div", element("table", *parts), class_="scroll", tabindex="0")


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _cell(value: object) -> str:
    if value is None:
        return "–"
    if isinstance(value, int | float) and not isinstance(value, bool):
        return number_text(value)
    return value if isinstance(value, str) else str(value)


def _body(parts: Iterable[str]) -> list[Html]:
    """Parts on lines of their own; plain text as paragraphs."""
    return [Html("\n") + (part if isinstance(part, Html) else element("p", part)) for part in parts]
