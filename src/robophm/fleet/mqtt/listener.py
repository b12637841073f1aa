"""The service's end of the wire: it takes what robots publish, and answers each once all is on the disk."""

from __future__ import annotations

import asyncio
import json
import logging
from contextlib import suppress
from typing import Any

from starlette.concurrency import run_in_threadpool

from robophm.core.errors import RobophmError, StoreError
from robophm.fleet.intake import Intake, RefusedError, said_of, token_in
from robophm.fleet.mqtt.connection import Connection, Lines
from robophm.transports.mqtt import Address

FIRST_WAIT, LONGEST_WAIT = 0.5, 30.0
"""Seconds until a broker that is lost or not there is tried again, twice as many each further time, and at most."""

LONGEST_MARK = 64
"""Bytes of what a robot tells an answer by, at most."""

_log = logging.getLogger("robophm")


async def listen(intake: Intake, place: Address) -> None:
    """Take in what comes over a broker, which is tried again whenever it is lost, until this is cancelled."""
    wait, said = FIRST_WAIT, ""
    while True:
        came: asyncio.Queue[Any] = asyncio.Queue()
        loop, lines = asyncio.get_running_loop(), Lines(place.root)

        def hear(message: Any, loop: asyncio.AbstractEventLoop = loop, came: asyncio.Queue[Any] = came) -> None:
            if message is None or message.qos:  # what comes with 0 is bounded by nothing
                with suppress(RuntimeError):  # the service has ended
                    loop.call_soon_threadsafe(came.put_nowait, message)

        try:
            connection = await run_in_threadpool(Connection, place, lines.reports(None), hear, lambda: hear(None))
        except RobophmError as error:
            if str(error) != said:
                _log.warning("%s; it is tried again", error)
            said = str(error)
        else:
            wait, said = FIRST_WAIT, ""
            _log.info("reports are taken at %s", place)
            try:
                await _Taking(intake, connection, lines).run(came)
            finally:
                connection.close()
            _log.warning("the connection to %s is lost; it is made anew", place)
        await asyncio.sleep(wait)
        wait = min(2 * wait, LONGEST_WAIT)


class _Taking:
    """The taking in of what comes over one connection; the broker hands over a bounded number of messages at once."""

    def __init__(self, intake: Intake, connection: Connection, lines: Lines) -> None:
        self._intake, self._connection, self._lines = intake, connection, lines

    async def run(self, came: asyncio.Queue[Any]) -> None:
        """Take in messages until one is None, many at once, acknowledged in their order."""
        taken: asyncio.Queue[tuple[Any, asyncio.Task[None]]] = asyncio.Queue()
        acknowledging = asyncio.create_task(self._acknowledge(taken))
        try:
            while message := await came.get():
                taken.put_nowait((message, asyncio.create_task(self._take(message))))
        finally:
            acknowledging.cancel()
            while not taken.empty():  # they are committed to their end: who is answered may be gone
                await asyncio.gather(taken.get_nowait()[1], return_exceptions=True)

    async def _acknowledge(self, taken: asyncio.Queue[tuple[Any, asyncio.Task[None]]]) -> None:
        while True:
            message, done = await taken.get()
            await asyncio.wait([done])
            self._connection.acknowledge(message)

    async def _take(self, message: Any) -> None:
        mark = getattr(message.properties, "CorrelationData", b"")[:LONGEST_MARK]
        robot = self._lines.robot_of(message.topic)
        answer = json.dumps(await self._answer(robot, message)).encode()
        self._connection.publish(self._lines.answers(robot), answer, mark)

    async def _answer(self, asked: str, message: Any) -> dict[str, object]:
        shown = [value for name, value in getattr(message.properties, "UserProperty", []) if name == "authorization"]
        try:
            robot = await self._intake.whose(token_in(shown[0]) if shown else None, asked)
            return {"status": 200, **said_of(await self._intake.commit(robot, bytes(message.payload)))}
        except RefusedError as refused:
            return {"status": refused.status, "message": str(refused)}
        except StoreError as error:  # the robot keeps it, and tries again
            _log.error("%s", error)
            return {"status": 503, "message": f"nothing of it is kept: {error}"}
        except Exception:
            _log.exception("reports of %s", message.topic)
            return {"status": 500, "message": "a fault within robophm; its log says where"}
