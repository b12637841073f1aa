"""Analysis of the new robot against a requirement, and against another design; nothing is changed."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from robophm.core.errors import DesignError
from robophm.health.importance import LONGEST
from robophm.report.compared_designs import Requirement, figure_rows, margin_text, new_figures, part_rows
from robophm.web.access.roles import needs
from robophm.web.prepared_robot import PreparedRobot
from robophm.web.routes.data import FileName, Upload
from robophm.web.routes.design import REFUSED
from robophm.web.routes.faults import FoundTables, table_of
from robophm.web.service import Served
from robophm.web.shapes import Shape, Unit

router = APIRouter(prefix="/api/analysis", tags=["analysis"])

Wanted = Annotated[float, Query(ge=1e-6, le=1 - 1e-12)]
Through = Annotated[float, Query(ge=1e-3, le=LONGEST)]


class Margin(Shape):
    """The margin by which a new robot has a reliability that is required, or misses it."""

    met: bool
    says: str


@router.get("/requirement", responses=REFUSED)
def get_requirement(service: Served, reliability: Wanted = 0.9, hours: Through = 1000.0) -> Margin:
    """Say whether the new robot works through so many hours of operation with a reliability that is required."""
    required = Requirement(reliability, hours)
    found = new_figures(service.prepared().new, required)
    return Margin(met=found.works >= reliability, says=margin_text(found, required))


@router.post("/compared", responses=REFUSED)
@needs("viewer")
def get_compared(
    body: Upload,
    service: Served,
    name: FileName,
    reliability: Wanted = 0.9,
    hours: Through = 1000.0,
    unit: Unit = "1/h",
) -> FoundTables:
    """Another design's file beside the design: the figures of the new robots, and which parts' rates make them."""
    try:
        other = service.prepared_text(body.decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise DesignError(f"{name:.100}: is no text; expected a design, .yaml") from None
    except DesignError as error:
        raise DesignError(f"{name:.100}: {error}") from None
    mine, required = service.prepared(), Requirement(reliability, hours)
    before, after = (new_figures(one.new, required) for one in (mine, other))
    titles = ["the design", f"{name:.100}", "change"]
    return FoundTables(
        tables=[
            table_of("The robots when new", ["", *titles], figure_rows(before, after, required, unit), [1, 2, 3]),
            table_of(
                "Parts whose hazard rate when new is another",
                ["part", *titles], part_rows(_parts(mine), _parts(other), unit), [1, 2, 3],
            ),
        ],
        notes=[
            f"The design: {margin_text(before, required)}.", f"{name:.100}: {margin_text(after, required)}.",
            "Behind redundancy the robot's figures change by less than those of the part.",
        ],
    )  # fmt: skip


def _parts(prepared: PreparedRobot) -> dict[str, float]:
    return {part.path: prepared.rates[part.path] for part in prepared.robot.all_components()}
