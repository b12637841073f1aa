"""The frame that every drawing shares: accessible, in the page's colours, inline or as a file of its own."""

from __future__ import annotations

from collections.abc import Iterable

from robophm.report.markup import Html, element, number
from robophm.report.style import FONT, palette


def svg(
    kind: str,
    content: Iterable[Html],
    *,
    title: str,
    description: str,
    style: str,
    view: tuple[float, float, float, float],
    scale: float = 1.0,
    standalone: bool = False,
) -> Html:
    """Return one SVG element of class ``kind`` that shows ``view`` (x, y, width, height) at ``scale``."""
    x, y, width, height = view
    head = [
        element("title", title),
        element("desc", description),
        element("style", Html(f"{palette('.phm')}.{kind} text{{font-family:{FONT}}}{style}")),
    ]
    if standalone:
        head.append(element("rect", x=x, y=y, width=width, height=height, fill="var(--paper)"))
    return element(
        "svg",
        Html("\n".join([*head, *filter(None, content)])),
        class_=f"phm {kind}",
        role="img",
        viewBox=" ".join(map(number, view)),
        width=width * scale,
        height=height * scale,
        xmlns="http://www.w3.org/2000/svg" if standalone else None,
    )


def text(x: float, y: float, content: str, kind: str = "") -> Html:
    """A line of text whose baseline starts at (x, y); nothing where there is no text."""
    return element("text", content, class_=kind, x=x, y=y) if content else Html()
