"""Notices of alarms by webhook and e-mail, from a thread of its own: whoever watches the robot never waits for them."""

from __future__ import annotations

import json
import os
import queue
import smtplib
import ssl
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from email.message import EmailMessage
from typing import Any, Self
from urllib.error import HTTPError
from urllib.parse import SplitResult, parse_qs, unquote, urlsplit
from urllib.request import HTTPRedirectHandler, ProxyHandler, Request, build_opener

from robophm.core.errors import RobophmError
from robophm.health.alarms import Alarm
from robophm.monitoring.alarm_watch import Told

PASSWORD = "ROBOPHM_SMTP_PASSWORD"
"""The variable of the environment that holds the password of a mail server."""

MOST_WAITING = 1000
"""Notices that wait to be sent to one address; of more the newest are dropped, and counted."""

TIMES = 5
"""How often a notice is tried."""

FIRST_WAIT = 1.0
"""Seconds between the first two tries; then twice as many each time."""

LONGEST_ANSWER = 10.0
"""Seconds to wait for an answer."""

LONGEST_END = 5.0
"""Seconds that are given to what still waits when watching ends."""

EXPECTED = "expected http://host/path, https://…, or smtp://user@host:25/?from=robot@example.org&to=team@example.org"


class Notices:
    """Tells some addresses of alarms that begin or end; a context manager. Each is told once, in order."""

    def __init__(self, addresses: Sequence[str] = (), *, first_wait: float = FIRST_WAIT) -> None:
        """Prepare to tell. Raises RobophmError for an address that is none."""
        self.notes: Counter[str] = Counter()
        """Counts of what could not be told, and why."""
        self._outlets = [_Outlet(_sender(one), self.notes, first_wait) for one in addresses]

    def of(self, robot: str) -> Told:
        """Return what takes the alarms of a robot, by its name; it never waits."""

        def told(changed: Sequence[Alarm], _: Sequence[Alarm]) -> None:
            for alarm in changed:
                for outlet in self._outlets:
                    outlet.put((robot, alarm))

        return told

    def close(self) -> None:
        """Give what waits a few seconds, then end."""
        end = time.monotonic() + LONGEST_END
        for outlet in self._outlets:
            outlet.close(end)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


_Notice = tuple[str, Alarm]
"""The name of a robot, and an alarm of it."""

_Send = Callable[[str, Alarm], None]


class _Outlet:
    """One address, with a thread that sends what waits."""

    def __init__(self, send: tuple[str, _Send], notes: Counter[str], first_wait: float) -> None:
        self._place, self._send = send
        self._notes, self._first_wait = notes, first_wait
        self._waiting: queue.Queue[_Notice | None] = queue.Queue(MOST_WAITING)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"notices to {self._place}", daemon=True)
        self._thread.start()

    def put(self, notice: _Notice) -> None:
        try:
            self._waiting.put_nowait(notice)
        except queue.Full:
            self._notes[f"notices to {self._place} dropped: too many wait"] += 1

    def close(self, end: float) -> None:
        with suppress(queue.Full):
            self._waiting.put(None, timeout=max(0.0, end - time.monotonic()))
        self._thread.join(timeout=max(0.0, end - time.monotonic()))
        self._over.set()

    def _run(self) -> None:
        while (notice := self._waiting.get()) is not None and not self._over.is_set():
            self._try(*notice)

    def _try(self, robot: str, alarm: Alarm) -> None:
        why = ""
        for count in range(TIMES):
            if count and self._over.wait(self._first_wait * 2 ** (count - 1)):
                break
            try:
                self._send(robot, alarm)
            except (OSError, smtplib.SMTPException, ValueError) as error:
                why = " ".join(str(error).split()) or type(error).__name__
                if isinstance(error, HTTPError) and 300 <= error.code < 500 and error.code != 429:
                    break  # it will say so again
            else:
                return
        self._notes[f"a notice to {self._place} was not taken: {why}"] += 1


def _sender(address: str) -> tuple[str, _Send]:
    """A name of an address without its secrets, and what sends an alarm there. Raises RobophmError."""
    try:
        where = urlsplit(address)
        port, host = where.port, where.hostname
    except ValueError as error:
        raise RobophmError(f"{address!r:.100} cannot be told of alarms: {error}; {EXPECTED}") from None
    if where.scheme not in ("http", "https", "smtp", "smtps") or not host:
        raise RobophmError(f"{address!r:.100} cannot be told of alarms: {EXPECTED}")
    place = f"{where.scheme}://{host}" + (f":{port}" if port else "")
    if where.scheme.startswith("http"):
        return place, lambda robot, alarm: _post(address, webhook_body(robot, alarm))
    said = parse_qs(where.query)
    if said.keys() != {"from", "to"}:
        raise RobophmError(f"{address!r:.100} cannot be told of alarms: {EXPECTED}")
    return place, lambda robot, alarm: _mail(where, said["from"][0], said["to"], robot, alarm)


# -- webhooks


def webhook_body(robot: str, alarm: Alarm) -> dict[str, Any]:
    """Return what Prometheus' Alertmanager posts to a webhook (version 4 of its data), for one alarm."""
    status = "firing" if alarm.end is None else "resolved"
    labels = {
        "alertname": alarm.what, "robot": robot, "path": alarm.path or robot, "severity": _SEVERITY[alarm.severity],
    }  # fmt: skip
    notes = {"summary": _summary(robot, alarm), "description": _description(alarm)}
    one = {
        "status": status, "labels": labels, "annotations": notes, "startsAt": _time(alarm.begin),
        "endsAt": _NOT_YET if alarm.end is None else _time(alarm.end), "generatorURL": "",
        "fingerprint": f"{alarm.begin:016x}",
    }  # fmt: skip
    return {
        "version": "4", "groupKey": f"{{}}:{{alertname={json.dumps(alarm.what)}, robot={json.dumps(robot)}}}",
        "truncatedAlerts": 0, "status": status, "receiver": "robophm", "groupLabels": labels, "commonLabels": labels,
        "commonAnnotations": notes, "externalURL": "", "alerts": [one],
    }  # fmt: skip


_SEVERITY = {"error": "critical", "warn": "warning"}
_NOT_YET = "0001-01-01T00:00:00Z"
"""The time of what has not ended, as programs in Go write it."""


class _NoRedirect(HTTPRedirectHandler):
    """An address that sends elsewhere is refused: where notices go is said on the command line alone."""

    def redirect_request(self, *_: Any, **__: Any) -> None:
        return None


_OPENER = build_opener(ProxyHandler({}), _NoRedirect())


def _post(address: str, body: Mapping[str, Any]) -> None:
    data = json.dumps(body).encode()
    request = Request(address, data, {"content-type": "application/json", "user-agent": "robophm"})
    with _OPENER.open(request, timeout=LONGEST_ANSWER) as answer:
        answer.read(1000)


# -- e-mail


def _mail(where: SplitResult, sender: str, receivers: Sequence[str], robot: str, alarm: Alarm) -> None:
    letter = EmailMessage()
    letter["Subject"] = " ".join(_summary(robot, alarm).split())[:200]
    letter["From"], letter["To"] = sender, ", ".join(receivers)
    letter["Date"] = _date(time.time_ns())
    letter.set_content(f"{_description(alarm)}\n\nIt began {_date(alarm.begin)}.\n")
    host, context = where.hostname or "", ssl.create_default_context()
    with (
        smtplib.SMTP_SSL(host, where.port or 465, timeout=LONGEST_ANSWER, context=context)
        if where.scheme == "smtps"
        else smtplib.SMTP(host, where.port or 25, timeout=LONGEST_ANSWER)
    ) as server:
        if where.username:
            if where.scheme == "smtp":
                server.starttls(context=context)  # a password goes out in no other way
            server.login(unquote(where.username), os.environ.get(PASSWORD, ""))
        server.send_message(letter)


def _summary(robot: str, alarm: Alarm) -> str:
    if alarm.end is not None:
        return f"[{robot}] over: {alarm.what}"
    return f"[{robot}] {'not known whether it goes on' if alarm.doubt else alarm.severity}: {alarm.cause}"


def _description(alarm: Alarm) -> str:
    if alarm.end is not None:
        return f"{alarm.cause}. It is over: {alarm.ended_by}."
    doubt = f" Whether it goes on is not known: it {alarm.doubt}." if alarm.doubt else ""
    return f"{alarm.cause}.{doubt}"


def _moment(time_: int) -> datetime:
    return datetime(1970, 1, 1, tzinfo=UTC) + timedelta(microseconds=time_ // 1000)


def _time(time_: int) -> str:
    return f"{_moment(time_):%Y-%m-%dT%H:%M:%S.%f}Z"


def _date(time_: int) -> str:
    return f"{_moment(time_):%a, %d %b %Y %H:%M:%S +0000}"
