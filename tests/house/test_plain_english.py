"""Phrases that a newcomer has to read three times are not used where the field has a plain word."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
READ = {
    ".": ("*.md",),
    "docs": ("**/*.md",),
    "examples": ("**/*.md",),
    "changelog.d": ("*.md",),
    "src/robophm": ("**/*.py",),
    "ui/src": ("**/*.ts", "**/*.tsx"),
}
"""What people read: documents, docstrings, the help and the messages of commands, the page."""

REFUSED = {
    r"\bas (?:they were |it was )?lived\b": "sensor-based, or by the stress that was measured",
    r"\bput(?:ting)? (?:\w+ ){0,3}in new\b": "replaced, replacing",
    r"\bas (?:it was )?of late\b": "recently",
    r"\bwhat (?:was|is) not taken\b": "what was rejected, or refused",
    r"\bclient of one robot's service\b": "the page talks to the service of one robot",
    r"\bhas lived nothing\b": "has no operating time",
}
"""Each with what to write instead."""


def texts() -> list[tuple[Path, str]]:
    """All that people read, each line break taken for a blank."""
    found = [path for folder, kinds in READ.items() for kind in kinds for path in (ROOT / folder).glob(kind)]
    return [(path, " ".join(path.read_text("utf-8").split())) for path in found if "static" not in path.parts]


def test_plain_words_are_used() -> None:
    read = texts()
    assert len(read) > 500
    found = {
        f"{path.relative_to(ROOT)}: {hit.group()}": instead
        for path, text in read
        for pattern, instead in REFUSED.items()
        for hit in re.finditer(pattern, text, re.I)
    }
    assert found == {}


def test_each_phrase_is_found_where_it_is() -> None:
    riddles = (
        "nominal and as lived", "each part put in new now", "putting a component in new", "else as it was of late",
        "What was not taken", "The page is a client of one robot's service", "a new robot has lived nothing",
    )  # fmt: skip
    assert all(any(re.search(pattern, one, re.I) for pattern in REFUSED) for one in riddles)
    assert not any(re.search(pattern, "a new part lived for 5 h; in new robots", re.I) for pattern in REFUSED)
