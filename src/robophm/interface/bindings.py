"""Bindings for a design's inputs by what recordings have: ``robophm.bind``."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from robophm.core.argument_checks import path
from robophm.core.errors import DesignError
from robophm.design.file import load
from robophm.drafting.binding import bound_text
from robophm.drafting.bindings import Proposal, limits_of, proposals
from robophm.drafting.seen import look
from robophm.interface.asking import Paths, paths_of


@dataclass(frozen=True)
class Proposed:
    """Bindings that a design could have, and why other inputs have none; nothing is written yet."""

    design: Path
    proposals: tuple[Proposal, ...]
    notes: tuple[str, ...]

    def text(self, accepted: Iterable[Proposal] | None = None) -> str:
        """The design's text with these bindings in it, or with all. Raises DesignError."""
        return bound_text(self.design, self.proposals if accepted is None else accepted)


def bind(design: str | os.PathLike[str], recordings: Paths, urdf: str | os.PathLike[str] | None = None) -> Proposed:
    """Propose bindings for the inputs of a design file that nothing is bound to, with the values that were seen.

    ``urdf``: the robot's description, whose limits say what counts as a load. Raises DesignError or SourceError of what
    cannot be read.
    """
    file = path(design, "design", DesignError)
    robot = load(file)
    efforts = limits_of(None if urdf is None else path(urdf, "URDF", DesignError))
    found, notes = proposals(robot, look(paths_of(recordings, "recordings")), efforts)
    return Proposed(file, tuple(found), tuple(notes))
