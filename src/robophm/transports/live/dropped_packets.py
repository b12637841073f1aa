"""Packets that came to this process by UDP and were dropped since it did not read them in time, as the kernel counts.

Nothing else tells of them: of a message that was sent best effort, one packet of which is gone, DDS says no word.
"""

from __future__ import annotations

from pathlib import Path

_TABLES = ("/proc/self/net/udp", "/proc/self/net/udp6")


class DroppedPackets:
    """Counts the packets that the kernel dropped at the sockets of this process; where that is not told, none."""

    def __init__(self) -> None:
        self._before = _dropped()

    def fresh(self) -> int:
        """Return how many packets were dropped since this was asked last, at sockets that are still open."""
        before, self._before = self._before, _dropped()
        return sum(max(0, count - before.get(socket, 0)) for socket, count in self._before.items())


def _dropped() -> dict[str, int]:
    """Packets that were dropped so far, by the identity of each socket of this process."""
    try:
        lines = [line for table in _TABLES if Path(table).exists() for line in Path(table).read_text().splitlines()[1:]]
        counts = {one[9]: int(one[-1]) for one in map(str.split, lines) if one[-1] != "0"}
        own = {_opened(one) for one in Path("/proc/self/fd").iterdir()} if counts else ()
    except OSError:  # there is no /proc outside Linux
        return {}
    return {socket: count for socket, count in counts.items() if f"socket:[{socket}]" in own}


def _opened(descriptor: Path) -> str:
    try:
        return str(descriptor.readlink())
    except OSError:  # it was closed meanwhile
        return ""
