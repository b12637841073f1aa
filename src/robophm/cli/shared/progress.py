"""Progress bars, on a terminal alone."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

from robophm.monitoring.monitor import Monitor


@contextmanager
def progress(
    console: Console, spans: Iterable[tuple[int | None, int | None]], what: str
) -> Iterator[Callable[[Monitor], None] | None]:
    """A callback for every tick of a replay that moves a bar along these spans of time [ns]; None off a terminal."""
    known = [(first, last) for first, last in spans if first is not None and last is not None]
    if not known or not console.is_terminal:
        yield None
        return
    first, last = min(begin for begin, _ in known), max(end for _, end in known)
    with _bar(console) as bar:
        task = bar.add_task(what, total=max(last - first, 1))
        yield lambda monitor: bar.update(task, completed=(monitor.ledger.integrated_to or first) - first)


@contextmanager
def counted(console: Console, what: str) -> Iterator[Callable[[int, int], None]]:
    """A callback for how many of how many are done, that moves a bar; nothing off a terminal."""
    if not console.is_terminal:
        yield lambda done, total: None
        return
    with _bar(console) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def _bar(console: Console) -> Progress:
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    return Progress(*columns, console=console, transient=True)
