"""A URDF becomes a draft of a design: what moves its joints, and the sensors on its links, as parts of the library.

Neither motors nor rates are in a URDF. What a joint is moved by is taken from names of meshes that a maker's part has,
else from its use and limits, and each such guess is said beside the part. xacro is refused in words.
"""

from __future__ import annotations

from pathlib import Path

from robophm.core.errors import DesignError
from robophm.design.draft import DraftPart, assumed_usage, design_text
from robophm.design.importers.urdf.drives import drive_parts
from robophm.design.importers.urdf.reading import Description, read_urdf
from robophm.design.importers.urdf.sensors import sensor_parts
from robophm.design.naming import design_name
from robophm.parts import Entry

__all__ = ["Description", "described_parts", "import_urdf", "read_urdf"]


def described_parts(description: Description, drive: Entry | None = None) -> list[DraftPart]:
    """The parts that a description speaks of; ``drive``: what moves wheels and joints, where somebody said so."""
    return [*drive_parts(description, drive), *sensor_parts(description)]


def import_urdf(path: Path) -> str:
    """The text of a design with the parts that a URDF speaks of. Raises DesignError; nothing is written."""
    description = read_urdf(path)
    parts = described_parts(description)
    if not parts:
        raise DesignError(f"{path}: has neither a joint that moves nor a sensor; nothing of it can fail")
    head = [f"Drafted from {path.name}: what fails in it by the library of parts; correct what is not so."]
    usage = assumed_usage(parts)
    robot = {"name": design_name(description.name), **({"usage": usage} if usage else {})}
    return design_text(head, robot, parts)
