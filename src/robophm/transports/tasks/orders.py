"""Orders of VDA 5050, which a master control gives and an AMR drives: what an order plans, and when it is done.

``order``: nodes and edges; those that are released are to be driven. An update of the order has its number and a
higher ``orderUpdateId``, and releases more. ``state``: while the AMR drives, ``nodeStates`` and ``edgeStates`` are what
is left of it; it is done when nothing is left and all actions have ended. Source: VDA 5050 2.1, 6.6 and 6.10.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from robophm.core.signal import HOUR
from robophm.transports.tasks.told import DoneLeg, DoneTask, PlannedLeg, PlannedTask

ORDER_TOPICS = ("/order", "/state")
"""Topics of an AMR that tell of its orders."""

MOST_EDGES = 10_000
"""Edges of an order that are looked at."""

Place = tuple[float, float]


@dataclass
class _Order:
    """An order that is under way."""

    name: str
    released: int = -1
    """The highest sequence number of what was released so far."""
    distance: float = 0.0
    """The length of all released edges [m]; nan where one's is not known."""
    start: int | None = None
    """The time of the first state in which it is driven [ns]."""
    place: Place | None = None
    driven: float | None = None
    """The distance from position to position of the states [m]."""


class OrderListener:
    """Hears orders and states of one AMR, and which task each makes; what makes none is in ``notes``.

    The distance of a done order is the length of its edges, where the order was heard and says it, else that from
    position to position.
    """

    def __init__(self, notes: Counter[str]) -> None:
        self.notes = notes
        self._order: _Order | None = None
        self._ended = ""

    def hear(self, time: int, topic: str, message: Any) -> PlannedTask | DoneTask | None:
        """Return the task that this message plans or completes. Raises NOT_AS_EXPECTED where it is neither."""
        name = str(message.orderId)
        if hasattr(message, "nodes"):
            return self._planned(time, topic, name, message)
        return self._driven(time, topic, name, message)

    def _planned(self, time: int, topic: str, name: str, message: Any) -> PlannedTask | None:
        order = self._begun(name)
        legs = []
        for number, distance, speed in _edges(message):
            if number > order.released:
                order.distance += distance
                legs.append(PlannedLeg(distance, speed))
        order.released = max([order.released, *(int(one.sequenceId) for one in message.nodes if one.released)])
        if not all(math.isfinite(leg.distance) for leg in legs):
            self.notes[f"{topic}: an order that says neither the length of its edges nor where its nodes are"] += 1
            return None
        legs = [leg for leg in legs if leg.distance > 0]
        return PlannedTask(time, topic, tuple(legs)) if legs else None

    def _begun(self, name: str) -> _Order:
        if self._order is None or self._order.name != name:
            if self._order and self._order.start is not None:
                self.notes["an order without an end"] += 1
            self._order = _Order(name)
        return self._order

    def _driven(self, time: int, topic: str, name: str, message: Any) -> DoneTask | None:
        left = len(message.nodeStates) + len(message.edgeStates)
        if not name or (name == self._ended and not left and self._order is None):
            return None
        if left:
            begun = self._begun(name)
            begun.start = time if begun.start is None else begun.start
            self._moved(begun, message)
            return None
        order = self._order
        if order is None or order.name != name or order.start is None or not _all_ended(message):
            return None
        self._moved(order, message)
        self._order, self._ended = None, name
        if _failed(message):
            self.notes["an order that ended without success"] += 1
            return None
        distance = order.distance if order.released >= 0 and math.isfinite(order.distance) else order.driven
        if distance is None:
            self.notes[f"{topic}: an order that is done, of which nothing says how far it was"] += 1
            return None
        return DoneTask(order.start, time, topic, (DoneLeg(distance, (time - order.start) / HOUR),))

    def _moved(self, order: _Order, message: Any) -> None:
        """Take the position of a state, where the AMR knows it."""
        place = getattr(message, "agvPosition", None)
        if place is None or not place.positionInitialized or not _finite(here := (place.x, place.y)):
            return
        order.driven = (order.driven or 0.0) + (math.dist(order.place, here) if order.place else 0.0)
        order.place = here


def tells_of_order(message: Any) -> bool:
    """Whether a message is an order of VDA 5050, or a state that tells of one."""
    return hasattr(message, "orderId") and (hasattr(message, "nodes") or hasattr(message, "nodeStates"))


def _edges(message: Any) -> Iterator[tuple[int, float, float | None]]:
    """Sequence number, length [m] and speed [m/s] of each released edge."""
    places = {str(one.nodeId): one.nodePosition for one in message.nodes if getattr(one, "nodePosition", None)}
    for edge in message.edges[:MOST_EDGES]:
        if edge.released:
            length, speed = getattr(edge, "length", None), getattr(edge, "maxSpeed", None)
            ends = [places.get(str(one)) for one in (edge.startNodeId, edge.endNodeId)]
            if length is None and all(ends):
                length = math.dist(*((float(one.x), float(one.y)) for one in ends if one))
            stated = float(speed) if speed is not None and math.isfinite(speed) and speed > 0 else None
            yield int(edge.sequenceId), math.nan if length is None else float(length), stated


def _all_ended(message: Any) -> bool:
    return all(one.actionStatus in ("FINISHED", "FAILED") for one in message.actionStates)


def _failed(message: Any) -> bool:
    """Whether an action failed, or the order was cancelled, by which all that is left of it is dropped too."""
    return any(
        one.actionStatus == "FAILED" or getattr(one, "actionType", "") == "cancelOrder" for one in message.actionStates
    )


def _finite(place: Place) -> bool:
    return all(isinstance(one, int | float) and math.isfinite(one) for one in place)
