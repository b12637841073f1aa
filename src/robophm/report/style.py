"""Colours and state symbols shared by diagrams, curves and pages, on light, on dark and on paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Tone = Literal["ok", "warn", "error", "stale"]
"""State of a part or a figure."""


@dataclass(frozen=True)
class Mark:
    """The mark of a tone without colour: a word, a character, an ASCII character, a path on 10 × 10."""

    word: str
    symbol: str
    plain: str
    path: str


MARKS: dict[Tone, Mark] = {
    "ok": Mark("OK", "", "", "M.8 5.3 2.2 3.9 4 5.7 7.8 1.9 9.2 3.3 4 8.5Z"),
    "warn": Mark("WARN", "▲", "!", "M5 .8 9.8 9.2H.2Z"),
    "error": Mark("ERROR", "✖", "x", "M1 2.5 2.5 1 5 3.5 7.5 1 9 2.5 6.5 5 9 7.5 7.5 9 5 6.5 2.5 9 1 7.5 3.5 5Z"),
    "stale": Mark("STALE", "?", "?", "M5 .3a4.7 4.7 0 1 0 .01 0ZM4.3 2.2H5.7V4.6H7.6V6H4.3Z"),
}

# Told apart without red-green vision: by lightness here, by symbol always.
_LIGHT = {
    "ink": "#1b2430", "quiet": "#586374", "line": "#8792a2", "edge": "#c9d0d9", "paper": "#ffffff",
    "card": "#ffffff", "shade": "#f3f5f8", "gate": "#3d5fc0",
    "ok": "#00886a", "warn": "#b87500", "error": "#b3123a", "stale": "#7d8796",
    "c0": "#0065a9", "c1": "#c65100", "c2": "#007d5c", "c3": "#a3397f", "c4": "#8a6a00", "c5": "#4a4f57",
}  # fmt: skip
_DARK = {
    "ink": "#e8ecf2", "quiet": "#a3adbb", "line": "#76828f", "edge": "#414b58", "paper": "#12161c",
    "card": "#1b2129", "shade": "#1b2129", "gate": "#8fa9f7",
    "ok": "#3ccf9f", "warn": "#f2b640", "error": "#ff7189", "stale": "#8b96a5",
    "c0": "#5fb4f0", "c1": "#ff9a52", "c2": "#45cfa4", "c3": "#e58cc6", "c4": "#e3c34a", "c5": "#b9c1cc",
}  # fmt: skip
FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue','DejaVu Sans',sans-serif"


def palette(selector: str) -> str:
    """CSS that gives ``selector`` the colours as variables: light, dark where preferred, light on paper."""
    light, dark = (";".join(f"--{name}:{colour}" for name, colour in c.items()) for c in (_LIGHT, _DARK))
    return (
        f"{selector}{{{light};color-scheme:light dark}}"
        f"@media screen and (prefers-color-scheme:dark){{{selector}{{{dark}}}}}"
    )


def on_paper() -> Mapping[str, str]:
    """The colours by the names of their variables, as they are printed."""
    return _LIGHT
