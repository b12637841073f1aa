"""Other files as a design: ``robophm.import_bom`` of a parts list, ``robophm.import_legacy`` of the 2020 tool."""

from __future__ import annotations

import os

from robophm.core.argument_checks import instance, path
from robophm.core.errors import DesignError
from robophm.design.importers import bom
from robophm.design.importers.bom import ImportedList
from robophm.design.importers.bom.assumptions import Assumptions
from robophm.design.importers.legacy import reading


def import_bom(
    parts_list: str | os.PathLike[str], design: str | os.PathLike[str], *, module: str = "",
    environment: str | None = None, temperature: str = Assumptions.temperature, stress: float = Assumptions.stress,
    quality: str | None = None,
) -> ImportedList:  # fmt: skip
    """Put the parts of a list into a design, a new one where there is no such file, as text: nothing is written.

    ``module``: where they belong, "Power/Motor board"; else as ``robophm import-bom`` takes it. Raises DesignError.
    """
    steps = instance(module, str, "module", "names with / between them", DesignError).split("/") if module else []
    if not all(step.strip() for step in steps):
        raise DesignError(f"module {module!r:.80}: expected names with / between them")
    return bom.import_bom(
        path(parts_list, "parts list", DesignError), path(design, "design", DesignError),
        assumptions=Assumptions(temperature, stress, quality=quality), environment=environment, module=steps,
    )  # fmt: skip


def import_legacy(source: str | os.PathLike[str]) -> reading.Imported:
    """Make a design of a file of the 2020 tool, as text, with what is odd in it: nothing is written.

    Raises DesignError, with file and line, for what is no such file.
    """
    return reading.import_legacy(path(source, "file of the 2020 tool", DesignError))
