"""A block diagram prepared to be asked, apart from the robot whose parts it draws: as far as its wiring alone goes."""

from __future__ import annotations

from functools import cached_property

from robophm.blocks.diagram import Block
from robophm.blocks.given_it_works import StructureGivenItWorks
from robophm.blocks.merging import merge_series
from robophm.blocks.reliability import Structure
from robophm.blocks.single_points import single_points_of_failure


class PreparedDiagram:
    """A diagram prepared once: what stands in series merged, and the structure that is left."""

    def __init__(self, diagram: Block) -> None:
        self.diagram = diagram
        (self.merged,), self.stands_for = merge_series(diagram)
        self.structure = Structure(self.merged)
        """Structure of the merged diagram."""
        self.conditional = StructureGivenItWorks(self.merged, structure=self.structure)

    @cached_property
    def single_points(self) -> frozenset[str]:
        """Return the units without each of which it fails."""
        return single_points_of_failure(self.diagram)
