"""Robots of one design that one process watches side by side, each in a thread of its own."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

from robophm.cli.shared.output import warn
from robophm.core.errors import RobophmError, SourceError
from robophm.transports.live.shared_source import EndedBeforeError, SharedSource, robots_of
from robophm.transports.signals.source import LiveSource

LOOK_EVERY, MOST_ROBOTS = 5.0, 32
"""Seconds between two looks for robots that came later, and how many robots one process watches."""

End = TypeVar("End")


def side_by_side(
    source: LiveSource,
    pattern: str,
    heard_now: Sequence[str],
    one: Callable[[str, LiveSource, int], End],
    further: Callable[[], LiveSource],
) -> list[End]:
    """Watch the robots that are heard now, and those of this pattern that come later; return what each ended with.

    ``one`` watches the robot of a name until its source ends; it is told how many are watched with it. Those that are
    heard later have each a source of their own, which ``further`` opens. Raises the first error, after the others have
    ended.
    """
    told = set[str]()
    names = _as_many_as_can_be(heard_now, 0, told)
    print(f"watching {len(names)} robots: {', '.join(names)}", file=sys.stderr)
    shared = SharedSource(source, names)
    later: dict[str, LiveSource] = {}

    def watched(name: str, heard: LiveSource, robots: int) -> End:
        try:
            return one(name, heard, robots)
        except RobophmError as error:
            if name in later:
                warn(f"{name} is watched no more: {error}")
            raise type(error)(f"{name}: {error}") from None
        finally:
            heard.close()

    with ThreadPoolExecutor(MOST_ROBOTS, "robophm") as pool:
        ends = [pool.submit(watched, name, shared.parts[name], len(names)) for name in names]
        first = [*ends]
        try:
            while wait(first, LOOK_EVERY).not_done:
                with suppress(SourceError):  # none is heard now, or the source cannot be asked
                    new = [name for name in robots_of(source, pattern) if name not in names]
                    for name in _as_many_as_can_be(new, len(names), told):
                        later[name] = further()
                        names.append(name)
                        print(f"watching {name} too", file=sys.stderr)
                        ends.append(pool.submit(watched, name, later[name], MOST_ROBOTS))
        finally:
            for heard in later.values():
                heard.stop()
    failed = [error for end in ends if (error := end.exception())]
    failed.sort(key=lambda error: isinstance(error, EndedBeforeError))
    if failed:
        raise failed[0]
    return [end.result() for end in ends]


def file_of_robot(path: Path | None, name: str) -> Path | None:
    """Return the file of one of several robots, ``health.amr_2.mcap`` for ``health.mcap``."""
    return path and path.with_stem(f"{path.stem}.{name.replace('/', '.')}")


def _as_many_as_can_be(names: Sequence[str], watched: int, told: set[str]) -> list[str]:
    """Return the first of these robots, as many as one process watches beside others; warn once of each further one."""
    room = MOST_ROBOTS - watched
    for name in names[room:]:
        if name not in told and len(told) < MOST_ROBOTS:
            told.add(name)
            warn(f"robot {name} is not watched: one process watches {MOST_ROBOTS} at most; expected another for it")
    return [*names[:room]]
