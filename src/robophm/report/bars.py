"""Bars of a few shares, one below the other; one or two of each. Or one as a line of text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from robophm.report.markup import Html, element, text_width
from robophm.report.svg import svg, text
from robophm.report.words import share_text

_SIZE = 11.0
_BAR, _GAP, _LONGEST = 9.0, 7.0, 420.0
_MOST_LETTERS = 60
_STYLE = (
    f".bars text{{font-size:{_SIZE:g}px;fill:var(--quiet)}}"
    ".bars .title{font-size:13px;font-weight:600;fill:var(--ink)}"
    ".bars .name{text-anchor:end;fill:var(--ink)}.bars .c0{fill:var(--c0)}.bars .c1{fill:var(--c1)}"
)


_EIGHTHS = " ▏▎▍▌▋▊▉"


def bar_text(share: float, width: int = 40) -> str:
    """A bar of at most ``width`` characters for a share from 0 to 1, to an eighth of a character."""
    eighths = round(8 * width * share)
    return "█" * (eighths // 8) + _EIGHTHS[eighths % 8].strip()


def bars_svg(rows: Mapping[str, Sequence[float]], names: Sequence[str], *, title: str) -> Html:
    """Shares from 0 to 1 of each row, a bar for each of ``names``; a share that is not a number has none."""
    labels = [name if len(name) <= _MOST_LETTERS else "…" + name[1 - _MOST_LETTERS :] for name in rows]
    left = max((text_width(label, _SIZE) for label in labels), default=0.0) + 12
    most = max((share for shares in rows.values() for share in shares if share == share), default=0.0) or 1.0
    content, at = [text(2, 14, title, "title")], 2.0
    for i, name in enumerate(names if len(names) > 1 else ()):
        content.append(element("rect", class_=f"c{i}", x=at, y=24, width=10, height=10))
        content.append(text(at + 15, 33, name))
        at += text_width(name, _SIZE) + 36
    y = 44.0
    for label, shares in zip(labels, rows.values(), strict=True):
        height = _BAR * len(shares)
        content.append(text(left - 8, y + height / 2 + 4, label, "name"))
        for i, share in enumerate(shares):
            if share != share:
                continue
            width = share / most * _LONGEST
            content.append(element("rect", class_=f"c{i}", x=left, y=y + i * _BAR, width=width, height=_BAR - 1))
        known = [share for share in shares if share == share]
        words = share_text(known[-1]) if known else "–"
        longest = max(known, default=0.0) / most * _LONGEST
        content.append(text(left + longest + 6, y + height / 2 + 4, words))
        y += height + _GAP
    shown = ([f"{name} {share_text(share)}" for name, share in zip(names, shares, strict=True)]
             for shares in rows.values())  # fmt: skip
    said = "; ".join(f"{label} {', '.join(each)}" for label, each in zip(labels, shown, strict=True))
    view = (0.0, 0.0, left + _LONGEST + 70, y)
    return svg("bars", content, title=title, description=said, style=_STYLE, view=view)
