"""Docstrings say in a sentence of plain English what a thing is, to a reader who does not know this project.

A docstring that leaves its subject to be guessed ("Of any course.", "As it is.", "That are remembered.") is refused by
the word that it begins with. Two kinds are printed to users as they are, and exempt: those of commands, which are their
lines of help, and those of handbook models, which are their formulas.
"""

import ast
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MODULES = sorted(path for path in (ROOT / "src" / "robophm").rglob("*.py") if "static" not in path.parts)
FEWEST_WORDS = 3
FRAGMENTS = {
    "Above", "After", "Also", "And", "As", "At", "Below", "Beside", "Between", "Beyond", "Both", "But", "By", "For",
    "From", "Goes", "If", "In", "It", "Its", "Less", "More", "Nor", "Not", "Now", "Null", "Of", "Or", "Per",
    "Raises", "Same", "See", "Since", "So", "That", "Them", "Then", "Those", "To", "Under", "Until", "What",
    "Where", "Who", "Whom", "Whose", "With",
}  # fmt: skip
"""First words of docstrings that are no sentences."""
SHOWN_TO_USERS = {"command": "src/robophm/cli", "hazard_rate": "src/robophm/hazard/handbooks"}
"""Functions whose docstrings are printed as they are, by name, and the folder that these are in."""

Named = tuple[str, str]


def is_text(node: ast.stmt) -> bool:
    """Whether a statement is a string that stands alone."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def of_fields(body: list[ast.stmt]) -> Iterator[Named]:
    """The docstrings behind fields and constants, with their names, wherever in these statements they stand."""
    for field, text in pairwise(body):
        if isinstance(field, ast.Assign | ast.AnnAssign) and is_text(text):
            target = field.target if isinstance(field, ast.AnnAssign) else field.targets[0]
            yield ast.unparse(target), ast.literal_eval(text.value)  # type: ignore[attr-defined]
    for node in body:
        for inner in ("body", "orelse"):
            if not isinstance(node, ast.ClassDef | ast.FunctionDef) and isinstance(
                below := getattr(node, inner, 0), list
            ):
                yield from of_fields(below)


def docstrings(node: ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef, name: str) -> Iterator[Named]:
    """The docstrings of a module, class or function and of all that is public in it."""
    if text := ast.get_docstring(node):
        yield name, text
    if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) or node.name == "__init__":
        yield from of_fields(node.body)
    for one in node.body:
        if isinstance(one, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and (
            not one.name.startswith("_") or one.name.startswith("__")
        ):
            yield from docstrings(one, one.name)


def is_fragment(text: str) -> bool:
    """Whether the first sentence of a docstring has too few words, or begins with a unit or a word that no sentence has
    there."""
    paragraph = " ".join(text.split("\n\n")[0].split())
    words = re.findall(r"\w+", re.split(r"(?<=[.!?])\s", paragraph)[0])
    return len(words) < FEWEST_WORDS or words[0] in FRAGMENTS or paragraph.startswith("[")


def fragments(module: Path) -> list[str]:
    """The docstrings of a file that are no sentences, each with the name of what it stands at."""
    place = module.relative_to(ROOT).as_posix()
    return [
        f"{place}: {name}: {text.partition(chr(10))[0]}"
        for name, text in docstrings(ast.parse(module.read_text("utf-8")), module.stem)
        if is_fragment(text) and not place.startswith(SHOWN_TO_USERS.get(name, "none"))
    ]


def test_docstrings_say_in_a_sentence_what_a_thing_is() -> None:
    assert [one for module in MODULES for one in fragments(module)] == []


@pytest.mark.parametrize(
    "text",
    [
        "Of any course.",
        "As it is.",
        "That are remembered of a live robot.",
        "Goes up with every report.",
        "What of it is in the ledger: so many samples, or all that was received before this time [ns].",
        "Of the system, hazard and wear together.",
        "[1/h]",
        "[s] before the newest sample; null where it never spoke.",
        "Beyond which a figure is not known.",
        "For people.",
    ],
)
def test_fragments_are_told(text: str) -> None:
    assert is_fragment(text)


def test_docstrings_of_fields_and_of_constants_are_read() -> None:
    module = '''
"""Rates of parts in a robot."""
MOST = 3
"""Of one robot."""
class Part:
    """One part of a robot."""
    rate: float
    """[1/h]"""
    def __init__(self):
        self.age = 0.0
        """In hours."""
    def _hidden(self):
        """As it is."""
'''
    found = dict(docstrings(ast.parse(module), "rates"))
    told = {"rates", "MOST", "Part", "rate", "self.age"}
    assert set(found) == told
    assert {name for name, text in found.items() if is_fragment(text)} == {"MOST", "rate", "self.age"}
