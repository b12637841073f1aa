"""Fault and event trees in the Open-PSA model exchange format, as other reliability tools read and write them.

Epstein, Rauzy and Reinhart, "Open-PSA Model Exchange Format", version 2.0d (2008). What is taken: fault trees of one
file or several, which may include each other, their gates of nested formulas, basic and house events, parameters and
common-cause groups, public and private, in any order, and trees whose events have no probabilities; event trees with
their rules and links, alignments and substitutions. Functions of libraries are refused in words.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from robophm.core.errors import DesignError
from robophm.design.importers.open_psa.definitions import Definitions
from robophm.design.importers.open_psa.model import Model

MOST_NAMED = 5

LACKS_A_QUESTION = "defines no gate, and no initiating event with an event tree"
"""The words for a model that answers nothing, behind its name."""

__all__ = ["LACKS_A_QUESTION", "Model", "load", "load_all"]


def load_all(path: Path | Sequence[Path], time: float | None = None, top: str | None = None) -> list[Model]:
    """Read a model, of one file or several, and return what it answers: its top events, and the sequences of its event
    trees, in each phase of its alignments.

    ``time`` is its mission time [h]. ``top``: the name of a gate, or of a sequence, alone. A model without gates and
    event trees answers nothing. Raises DesignError, one line with file and line, for what is no XML, not taken or
    contradicts itself; where only one is wanted, what it does not hang on may be wrong.
    """
    definitions = Definitions([path] if isinstance(path, Path) else list(path), time)
    models = [definitions.model(question) for question in definitions.questions(top)]
    if top is None:
        definitions.check()
    return models


def load(path: Path | Sequence[Path], time: float | None = None, top: str | None = None) -> Model:
    """Read the one thing that a model answers, as ``load_all``. Raises DesignError where it answers several."""
    definitions = Definitions([path] if isinstance(path, Path) else list(path), time)
    questions = definitions.questions(top)
    if not questions:
        raise DesignError(f"{definitions.where}: {LACKS_A_QUESTION}")
    if len(questions) > 1:
        names = [f"'{question.name}'{question.where}" for question in questions]
        named = ", ".join(names[:MOST_NAMED]) + (f" and {len(names) - MOST_NAMED} more" if names[MOST_NAMED:] else "")
        raise DesignError(
            f"{definitions.where}: answers {len(names)} questions: {named}; expected one, or the name of the top gate "
            "or sequence"
        )
    model = definitions.model(questions[0])
    if top is None:
        definitions.check()
    return model
