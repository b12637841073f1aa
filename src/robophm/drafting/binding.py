"""Bindings that somebody accepted, put into a design's text."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from ruamel.yaml.comments import CommentedMap, CommentedSeq

from robophm.design.editing import put
from robophm.design.file import DesignFile
from robophm.drafting.bindings import Proposal


def bound_text(path: str | os.PathLike[str], accepted: Iterable[Proposal]) -> str:
    """The text of a design file with these bindings in it; the rest is as it was. Raises DesignError."""
    design = DesignFile(Path(path))
    for one in accepted:
        binding = CommentedMap()
        for key, value in one.binding.items():
            binding[key] = CommentedSeq(value) if isinstance(value, list) else value
            if isinstance(value, list):
                binding[key].fa.set_flow_style()
        binding.fa.set_flow_style()
        put(design.document, one.place, binding)
    return design.text()
