"""The wear that a sensor sees of one failure mode, over time: its readings, the course foretold, its threshold."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from robophm.core.errors import DesignError, nearest
from robophm.core.signal import SECOND
from robophm.monitoring.wear_over_time import wear_over_time
from robophm.web.health import WornPart, worn_parts
from robophm.web.routes.design import REFUSED
from robophm.web.service import Served
from robophm.web.shapes import Shape

router = APIRouter(prefix="/api/wear", tags=["wear"])


class BandToCome(Shape):
    """The course that the readings alone foretell of the highest wear so far, up to the threshold."""

    times: list[float]
    """Times of the part's clock."""
    slow: list[float]
    """Level that is passed by then with 95 %."""
    median: list[float]
    fast: list[float]
    """Level that is passed by then with 5 %."""


class WearOverTime(Shape):
    """The wear of a failure mode; times on the clock of its part, in ``unit`` of what ``seen`` tells."""

    seen: WornPart
    """All that is known of it; its times are from the last reading on."""
    times: list[float]
    """Times of the readings, on the part's clock."""
    dates: list[float]
    """The same as moments [s since the epoch]."""
    values: list[float]
    band: BandToCome | None
    """The course to come; null where no trend of the readings leads to the threshold, or it is reached."""


@router.get("", responses=REFUSED)
def get_wear(service: Served, mode: Annotated[str, Query(max_length=5000)]) -> WearOverTime:
    """The wear of a failure mode, by its path, that a sensor sees."""
    prepared = service.prepared()
    exposure, unsettled = service.past(prepared)
    ledger = exposure.settled(unsettled)
    seen = {one.mode: one for one in prepared.seen_wear(exposure, unsettled)}
    modes = {one.path for one in prepared.robot.modes if one.path in seen and one.key in ledger.wear}
    found = wear_over_time(prepared.robot, ledger, mode) if mode in modes else None
    if found is None:
        raise DesignError(f"no wear is seen of '{mode}'{nearest(mode, modes)}")
    readings, band = found.readings, found.band
    return WearOverTime(
        seen=worn_parts([seen[mode]], prepared.plant)[0],
        times=readings.ages.tolist(),
        dates=(readings.when / SECOND).tolist(),
        values=readings.values.tolist(),
        band=None if band is None else BandToCome(**{name: one.tolist() for name, one in vars(band).items()}),
    )
