"""Sends what a robot's outbox has to its fleet, in a thread of its own that whoever watches never waits for."""

from __future__ import annotations

import http.client
import logging
import random
import threading
import time
from collections.abc import Callable
from contextlib import closing
from typing import Self

from robophm.core.errors import DataError, RobophmError, SourceError, StoreError
from robophm.fleet.address import FleetAddress
from robophm.fleet.payload import MOST_REPORTS, packed
from robophm.fleet.post import why_not
from robophm.fleet.way import LONGEST_ANSWER, Way, way_to
from robophm.stores import Address, open_store
from robophm.stores.outbox import Outbox

LOOK_EVERY = 2.0
"""Seconds between two looks for reports that wait."""

FIRST_WAIT, LONGEST_WAIT = 1.0, 60.0
"""Seconds until it is tried again after the first failure, twice as many after each further one, and at most."""

LONGEST_END = 5.0
"""Seconds that are given to what still waits when watching ends."""


class Sender:
    """Sends the reports of one robot as they come; a context manager.

    What it sends stays in the outbox until the fleet says that it has committed it. Oldest reports are sent first, and
    nothing before what is older is committed.
    """

    def __init__(
        self, store: Address, robot: str, fleet: FleetAddress, token: str, told: Callable[[str], None],
        *, look_every: float = LOOK_EVERY, first_wait: float = FIRST_WAIT,
        patience: float = LONGEST_ANSWER,
    ) -> None:  # fmt: skip
        """``robot``: its identity in its store; ``told`` is called with words when something begins to be in the way,
        and when that is over; ``patience``: seconds to wait for an answer."""
        self._store, self._robot, self._fleet, self._token, self._told = store, robot, fleet, token, told
        self._look_every, self._first_wait, self._patience = look_every, first_wait, patience
        self._trouble = ""
        self._stated = False
        """Whether the newest state has been sent since this began."""
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"reports to {fleet.service}", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Give what waits a few seconds, then end; what is not sent by then waits in the store. Twice does no harm."""
        self._ending.set()
        self._thread.join(timeout=LONGEST_END)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _run(self) -> None:
        failures = 0
        try:
            way = way_to(self._fleet, self._token, self._patience)
            with closing(way), open_store(self._store) as store:
                outbox = store.outboxes.of(self._robot)
                while True:
                    last = self._ending.is_set()
                    try:
                        more = self._send(way, outbox, last=last)
                        self._say("")
                        failures = 0
                    except (OSError, http.client.HTTPException, DataError, SourceError, StoreError) as error:
                        self._say(why_not(error))
                        more, failures = False, failures + 1
                    if last and not more:
                        return
                    if not more:
                        self._ending.wait(self._until_next(failures))
        except RobophmError as error:
            self._say(str(error))
        except Exception:  # a fault of ours must be seen, not end in a thread that nobody watches
            logging.getLogger("robophm").exception("sending reports")
            self._say("a fault within robophm, whose log says where, has ended the sending")

    def _until_next(self, failures: int) -> float:
        """Seconds to wait; never the same for all robots of a fleet that comes back."""
        if not failures:
            return self._look_every
        return min(self._first_wait * 2.0 ** min(failures - 1, 16), LONGEST_WAIT) * random.uniform(0.5, 1.5)

    def _send(self, way: Way, outbox: Outbox, *, last: bool) -> bool:
        """Send what has waited longest, where there is any; whether more waits."""
        batch = outbox.batch(MOST_REPORTS)
        if not batch.reports and (not batch.present or (self._stated and not last)):
            return False
        try:
            body = packed(self._fleet.robot, time.time_ns(), batch)
        except DataError as error:
            self._say(f"the robot's ledger and report are too large to be sent: {error}")
            batch = batch._replace(present=None)
            if not batch.reports:
                return False
            body = packed(self._fleet.robot, time.time_ns(), batch)
        way.send(body, batch)
        if batch.reports:
            outbox.trim(batch.reports[-1].number)
        self._stated = self._stated or batch.present is not None
        return batch.left > 0

    def _say(self, trouble: str) -> None:
        if trouble == self._trouble:
            return
        self._trouble = trouble
        where = f"fleet {self._fleet.service}"
        self._told(f"{where}: {trouble}; what is not sent waits in the store" if trouble else f"{where}: takes reports")
