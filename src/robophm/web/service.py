"""The state that routes share: one robot's design, its monitoring, its jobs."""

from __future__ import annotations

import gc
import sqlite3
import threading
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from fastapi import Depends, Request

from robophm.core.errors import DesignError, RobophmError
from robophm.design.drawable import Drawable
from robophm.design.identities import identities
from robophm.design.identity_edits import NOTHING, Lived
from robophm.design.problems import Problem as Found
from robophm.drafting.received import ReceivedFiles
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.ledger_parts import Fate, fates, lived
from robophm.health.outlooks import View, outlooks
from robophm.health.prognosis import Outlook
from robophm.health.why import Explanation
from robophm.monitoring.notices import Notices
from robophm.stores import Address
from robophm.web.access.file import AccessFile, access_path
from robophm.web.access.proxies import Proxies, is_loopback
from robophm.web.access.visitors import Visitors
from robophm.web.jobs import Jobs
from robophm.web.monitoring import Monitoring
from robophm.web.part_texts import PartTexts
from robophm.web.prepared_robot import PreparedRobot, rates_of
from robophm.web.shapes import DesignState, Problem
from robophm.web.sources import Choice, choices, chosen
from robophm.web.workspace import Draft, Workspace

if TYPE_CHECKING:
    from collections.abc import Mapping


LONGEST_END = 10.0
"""The most seconds to wait for a thread that is reading the design."""

QUICK_END = 2.0
"""The most seconds in which what was heard is taken, when the service ends."""

RETRIED_EVERY = 10.0
"""Seconds between two attempts to watch a robot that was to be watched from the start."""

MANY_PARTS = 1000
"""Levels and parts of a design that is large."""

FOLLOWED_EVERY = 1.0
"""Seconds between two looks at the design's file."""


@dataclass(frozen=True)
class Settings:
    """The settings that the service was started with."""

    design: Path
    store: Address | None = None
    journal: Path | None = None
    recordings: tuple[Path, ...] = ()
    seed: int | None = None
    """Seed of the synthetic robot, where it can be chosen."""
    host: str = "127.0.0.1"
    proxies: tuple[str, ...] = ()
    """Addresses of reverse proxies that are believed when they say who asks."""
    certificate: Path | None = None
    """Certificate of the service, and its key where that is in no file of its own."""
    key: Path | None = None
    own_store: bool = False
    """Whether the store is this robot's alone, as one beside its design is: recordings that are played do not count."""
    notify: tuple[str, ...] = ()
    """Addresses that are told of alarms."""
    embed: tuple[str, ...] = ()
    """Origins of pages inside which the wall may be shown."""
    for_fleet: bool = False
    """Whether the robot's reports go into the outbox of its store, to be sent to a fleet."""


class Service:
    """The service of one robot: its design, its monitoring and its jobs."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.workspace = Workspace(settings.design)
        access = access_path(settings.design)
        self._access = AccessFile(access if access.exists() or self.workspace.lasting else None)
        self.visitors = Visitors(self._access, reached_by_others=not is_loopback(settings.host),
                                 proxies=Proxies(settings.proxies))  # fmt: skip
        self.fingerprint = ""
        """SHA-256 fingerprint of the certificate; empty without TLS."""
        self.workspace.on_change = self.visitors.changes.design_changed
        self.notices = Notices(settings.notify)
        self.monitoring = Monitoring(
            settings.store, settings.journal, own=settings.own_store, notices=self.notices, for_fleet=settings.for_fleet
        )
        self.jobs = Jobs()
        self.received = ReceivedFiles(settings.design.with_name(settings.design.name + ".files"), settings.recordings)
        """The files that were handed in for a draft of the robot, in a folder beside its design."""
        self.seed = settings.seed
        """Seed of the synthetic robot, where it can be chosen."""
        self.changed_outside = False
        """Whether the file holds what somebody else has made of it, and taking it would lose edits or is impossible."""
        self.part_texts = PartTexts()
        self.told: tuple[Explanation, Explanation] | None = None
        """The reasons for its health that were asked for last, and the same with since when."""
        self.wanted = ""
        """The source by which the robot is to be watched from the start."""
        self._ended = threading.Event()
        # A design of thousands of parts takes seconds to be read: they are over when a browser asks.
        self._threads = [
            threading.Thread(target=work, name=name, daemon=True)
            for work, name in ((self._read_ahead, "read ahead"), (self._follow_file, "follow the file"))
        ]
        for thread in self._threads:
            thread.start()

    def _read_ahead(self) -> None:
        with suppress(RobophmError, sqlite3.Error):
            if len(self.design_state().levels) > MANY_PARTS:
                gc.collect()
                gc.freeze()  # else each edit waits while all of it is looked through for what can be let go of

    def _follow_file(self) -> None:
        while not self._ended.wait(FOLLOWED_EVERY):
            with suppress(RobophmError, sqlite3.Error):
                self.changed_outside = self.workspace.follow_file()

    @property
    def sources(self) -> Mapping[str, Choice]:
        """Return what the robot can be watched by, by name: recordings that were handed in among them."""
        return choices(self.received.recordings, seed=self.seed)

    def prepared(self, state: int | None = None) -> PreparedRobot:
        """Return the robot of the design now, or of an earlier state. Raises DesignError where that is no design."""
        text = None if state is None else self.workspace.text(state)
        return self.prepared_text(text)

    def prepared_text(self, text: str | None) -> PreparedRobot:
        """Return the robot of a text, None for the design now. Raises DesignError."""
        checked = self.workspace.checked.of(self.workspace.draft().text if text is None else text)
        if checked.robot is None:
            first = checked.problems[0]
            raise DesignError(f"{'/'.join(first.place) or 'the design'}: {first.message}")
        return self.workspace.checked.prepared.of(checked.robot)

    def to_draw(self) -> tuple[PreparedRobot, Drawable]:
        """Return the robot to be drawn, and what is wrong in it. Raises DesignError where there is nothing to draw."""
        text = self.workspace.draft().text
        drawn = self.workspace.checked.drawn(text)
        if drawn is None:
            drawn = Drawable(self.prepared_text(text).robot)  # which says why there is none
        return self.workspace.checked.prepared.of(drawn.robot), drawn

    def watch(self, source: str, speed: float) -> None:
        """Begin to watch the robot of the design now, from a source by its name, until it is stopped.

        ``speed``: of a recording, as a multiple of its own. Raises RobophmError.
        """
        choice = chosen(dict(self.sources), source)
        state = self.workspace.draft().state
        self.monitoring.start(self.prepared().robot, choice, speed, state)

    def keep_watching(self, source: str, speed: float) -> None:
        """Watch as ``watch``, and again where that fails, until a person stops it. Raises RobophmError at first."""
        self.wanted = source
        self.watch(source, speed)

        def again() -> None:
            while not self._ended.wait(RETRIED_EVERY) and not (self.monitoring.run and self.monitoring.run.stopped):
                if self.monitoring.state == "failed":
                    with suppress(RobophmError):
                        self.watch(source, speed)

        thread = threading.Thread(target=again, name="keep watching", daemon=True)
        self._threads.append(thread)
        thread.start()

    def past(self, prepared: PreparedRobot) -> tuple[ExposureIntegrator, Ledger]:
        """Return the robot's ledger as far as is known. Raises StoreError."""
        return ExposureIntegrator(prepared.robot), self.monitoring.last_ledger(prepared.robot)

    def lived(self) -> Lived:
        """Return what of the design now, and of what was in it, has a past. Raises StoreError."""
        checked = self.workspace.checked.of(self.workspace.draft().text)
        name = str(checked.document.get("identity") or checked.document.get("name"))
        pasts = self.monitoring.pasts(name)
        if not pasts:
            return NOTHING
        parts = identities(checked.robot) if checked.robot else ()
        found = [lived(data, parts) for data in pasts]
        every = {name}.union(*(one.every for one in found))
        return Lived(every, set().union(*(one.doubted or () for one in found)) if checked.robot else None)

    def fates(self) -> list[Fate] | None:
        """Return what becomes of the past under the design now; None where there is no past, or no valid design.

        Raises StoreError where it cannot be read, or is of the robot by another name.
        """
        robot = self.workspace.checked.of(self.workspace.draft().text).robot
        if robot is None:
            return None
        pasts = self.monitoring.pasts(robot.identity)
        if not pasts:
            self.monitoring.known_by_another_name(robot)
        return fates(pasts[0], identities(robot)) if pasts else None

    def outlooks(self, prepared: PreparedRobot) -> Mapping[View, Outlook]:
        """Return both views of the robot with its past as far as is known. Raises StoreError."""
        exposure, ledger = self.past(prepared)
        return outlooks(prepared.plant, exposure, ledger, wear=prepared.seen_wear(exposure, ledger))

    def design_state(self, draft: Draft | None = None) -> DesignState:
        """Return the design now, with all that is to be said of it."""
        draft = draft or self.workspace.draft()
        checked = self.workspace.checked.of(draft.text)
        name = checked.document.get("name")
        prepared = self.workspace.checked.prepared.of(checked.robot) if checked.robot and not checked.refused else None
        return DesignState(
            revision=draft.revision,
            state=draft.state,
            name=name if isinstance(name, str) else self.settings.design.stem,
            file=self.settings.design.name,
            document=json_values(checked.document),
            history=self.workspace.history,
            saved=draft.saved,
            undo=(draft.what or "the last change") if draft.undo else None,
            redo=draft.redo,
            valid=checked.robot is not None,
            problems=told(self.workspace.checked.problems(draft.text)),
            levels=prepared.levels if prepared else {},
            unknown={path: rates_of(one) for path, one in prepared.unknown.items()} if prepared else {},
        )

    def end_watching(self) -> None:
        """End monitoring, whose past is kept; nothing is watched again by itself."""
        self._ended.set()
        self.monitoring.stop(within=QUICK_END)

    def close(self) -> None:
        """End monitoring and jobs; let go of files."""
        self.end_watching()
        for thread in self._threads:
            thread.join(timeout=LONGEST_END)
        self.monitoring.stop(within=QUICK_END)  # one of them may just have begun to watch
        self.monitoring.close()
        self.notices.close()
        self.jobs.close()
        self.workspace.close()
        self._access.close()


def told(problems: Iterable[Found]) -> list[Problem]:
    """Return problems as they go over the wire."""
    return [
        Problem(level=one.level, place=list(one.place), message=one.message, line=one.line, column=one.column)
        for one in problems
    ]


def json_values(value: object) -> dict[str, object]:
    """Return a document as JSON can say it: numbers that are none, which a design may write, are words."""

    def plain(one: object) -> object:
        if isinstance(one, dict):
            return {key: plain(inner) for key, inner in one.items()}
        if isinstance(one, list):
            return [plain(inner) for inner in one]
        if isinstance(one, float) and one - one != 0:
            return str(one)
        return one

    found = plain(value)
    return found if isinstance(found, dict) else {}


def _service(request: Request) -> Service:
    service: Service = request.app.state.service
    return service


Served = Annotated[Service, Depends(_service)]
"""The service, in a route."""
