"""Text that goes into SVG and HTML: what is markup and what is only text, and how wide it will be."""

from __future__ import annotations

import html
import re
import unicodedata
from typing import SupportsIndex

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_EMPTY = frozenset({"path", "rect", "circle", "input"})  # the others have a closing tag: HTML takes no <div/>
_NARROW, _WIDE = frozenset("iIljtfr.,:;'|!()[]{}/\\- "), frozenset("mwMW@%…—–+×<>=")


class Html(str):
    """Markup that is safe as it is; any other text is escaped wherever it meets markup."""

    __slots__ = ()

    def __add__(self, other: str) -> Html:
        return Html(str.__add__(self, escape(other)))

    def __mul__(self, times: SupportsIndex) -> Html:
        return Html(str.__mul__(self, times))

    def _repr_html_(self) -> str:  # a notebook shows the drawing, not its source
        return self


def escape(text: str) -> Html:
    """Text as markup: escaped, without the characters that XML forbids; ``Html`` stays as it is."""
    if isinstance(text, Html):
        return text
    return Html(html.escape(_NOT_XML.sub("\ufffd", text)))


def element(name: str, *content: str, **attributes: str | float | None) -> Html:
    """An element; content that is not ``Html`` is escaped, attributes that are None or "" are left out.

    Attribute names: ``class_`` is class, ``text_anchor`` is text-anchor.
    """
    written = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escape(value) if isinstance(value, str) else number(value)}"'
        for key, value in attributes.items()
        if value is not None and value != ""
    )
    if name in _EMPTY:
        return Html(f"<{name}{written}/>")
    return Html(f"<{name}{written}>{''.join(map(escape, content))}</{name}>")


def number(value: float) -> str:
    """A coordinate with at most one decimal: 12, 12.5."""
    text = f"{value:.1f}".removesuffix(".0")
    return "0" if text == "-0" else text


def text_width(text: str, size: float, bold: bool = False) -> float:
    """Width of a text in a sans-serif font of that size, on the wide side of the common ones. [px]"""
    return size * (1.08 if bold else 1.0) * sum(map(_em, text))


def shorten(text: str, width: float, size: float, bold: bool = False) -> str:
    """The text, or as much of it as fits in ``width`` [px] with an ellipsis."""
    text = " ".join(text.split())
    if text_width(text, size, bold) <= width + 0.5:
        return text
    room = width - text_width("…", size, bold)
    for end, character in enumerate(text):
        room -= text_width(character, size, bold)
        if room < 0:
            return text[:end].rstrip() + "…"
    return text


def _em(character: str) -> float:
    if unicodedata.combining(character):
        return 0.0
    if unicodedata.east_asian_width(character) in "WF":
        return 1.0
    if character in _NARROW:
        return 0.38
    if character in _WIDE:
        return 0.93
    return 0.72 if character.isupper() else 0.62
