"""``robophm data list``, ``find``, ``statistics`` and ``export``."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import IO, Any

from rich.console import Console

from robophm.cli.output import console, may_make, print_json, print_table, progress_console, table, warn, write
from robophm.cli.progress import counted
from robophm.cli.unused import refuse_unused
from robophm.core.errors import RobophmError
from robophm.core.files import replacing
from robophm.core.signal import HOUR, SECOND
from robophm.core.units import quantity
from robophm.measured.export import SUFFIXES, export
from robophm.measured.find import MOST_HITS, Condition, Found, find
from robophm.measured.levels import marginal
from robophm.measured.overview import Overview, overview, per_second
from robophm.measured.recordings import Recorded, Signal, recordings, said, signal_of
from robophm.measured.statistics import Look, Window, statistics
from robophm.report.bars import bar_text
from robophm.report.curve import sparkline
from robophm.report.measured_page import Seen, level_rows, statistics_page
from robophm.report.words import duration_text, moment_text, number_text

MOST_KEPT = 100_000
"""Windows that ``--json`` has at most; ``--to`` writes all."""


@dataclass(frozen=True)
class Search:
    """What was asked to find, as it was written."""

    above: str | None
    below: str | None
    faster: str | None
    stuck: bool
    missing: bool
    at_least: str

    def condition(self, signal: Signal) -> Condition:
        """The same in the signal's unit."""
        above, below = (None if text is None else signal.level(text) for text in (self.above, self.below))
        faster = None if self.faster is None else signal.level(self.faster, "s")
        return Condition(above, below, faster, self.stuck, self.missing, nanoseconds(self.at_least))

    def __str__(self) -> str:
        words = [f"{name} {text}" for name, text in (("above", self.above), ("below", self.below)) if text is not None]
        words += [f"changing by more than {self.faster}"] if self.faster is not None else []
        words += [name for name, is_it in (("stuck", self.stuck), ("missing", self.missing)) if is_it]
        return f"{' and '.join(words)} for at least {self.at_least}"


def nanoseconds(text: str) -> int:
    """A written time. Raises UnitError."""
    seconds = quantity(text, "s")
    if not abs(seconds) < 2**62 / SECOND:
        raise RobophmError(f"'{text}' is too long; expected at most a century")
    return round(seconds * SECOND)


def max_age(gap: str) -> int:
    """How long a value holds. Raises RobophmError where that is no time."""
    time = nanoseconds(gap)
    if time <= 0:
        raise RobophmError(f"--gap {gap}: expected a time above zero")
    return time


def listed(bags: Sequence[Path], gap: str | None, *, as_json: bool) -> None:
    """Print what recordings hold."""
    silence = None if gap is None else max_age(gap)
    each = recordings(bags)
    shown: list[Overview] = []
    with counted(progress_console(), "reading") as advance:
        for done, one in enumerate(each):
            advance(done, len(each))
            shown.append(overview(one, silence))
    if as_json:
        print_json({"recordings": [_overview_json(one) for one in shown]})
        return
    out = console()
    for seen in shown:
        _print_overview(out, seen)
    _warn_of([note for seen in shown for note in _named(seen.name, seen.notes, several=len(shown) > 1)])


def _print_overview(out: Console, one: Overview) -> None:
    spans = [(topic.first, topic.last) for topic in one.topics if topic.first is not None and topic.last is not None]
    begin, end = min((a for a, _ in spans), default=0), max((b for _, b in spans), default=0)
    span = f"{moment_text(begin)}, {duration_text((end - begin) / HOUR)}" if spans else "no messages"
    rows = []
    for topic in one.topics:
        rate, first, last = per_second(topic), topic.first, topic.last
        heard = ["–", "–"]
        if first is not None and last is not None:
            heard = [duration_text(round((since - other) / 1e6) * 1e6 / HOUR)
                     for since, other in ((first, begin), (last, first))]  # fmt: skip
        gaps = "–"
        if topic.gap_count:
            at, length = max(topic.gaps, key=lambda gap: gap[1])
            gaps = f"{topic.gap_count:,}; {duration_text(length / HOUR)} from {moment_text(at)[5:19]}"
        per = "–" if rate is None else number_text(rate, 3)
        rows.append((topic.name, f"{topic.messages:,}", per, *heard, gaps))
    columns = ("topic", "messages", "per s", "first after", "for", "gaps; longest")
    print_table(out, table(f"{one.name}: {span}", columns, rows, figures=(1, 2, 3, 4)))
    out.print()
    fields = []
    for topic in one.topics:
        names = [f"{name} [{unit}]" if unit else name for name, unit in topic.fields.items() if "header." not in name]
        names += [f"{field} of {', '.join(of)}" for field, of in topic.names.items()]
        fields.append((topic.name, topic.type.replace("/msg/", "/") or "?", ", ".join(names) or "no numbers"))
    print_table(out, table("", ("topic", "type", "fields [unit]"), fields))
    out.print()


def _overview_json(one: Overview) -> dict[str, Any]:
    return {
        "name": one.name,
        "topics": [{**asdict(topic), "gaps": [list(gap) for gap in topic.gaps]} for topic in one.topics],
        "notes": said(one.notes),
    }


def found(
    bags: Sequence[Path], name: str, search: Search, gap: str, most: int, *, together: bool, as_json: bool
) -> None:
    """Print where what was looked for is."""
    if as_json:
        refuse_unused(
            "JSON, which lists as many as may be", ("signal", *(one.name for one in fields(Search)), "gap", "together")
        )
    age = max_age(gap)
    each = recordings(bags, together=together)
    signal = signal_of(name, each)
    condition = search.condition(signal)
    with counted(progress_console(), "searching") as advance:
        hits = find(each, signal, condition, age, advance)
    if as_json:
        print_json(_found_json(hits, signal, condition, age, each))
        return
    _print_found(console(), hits, signal, search, most, len(each))
    _warn_of(said(hits.notes))


def _print_found(out: Console, hits: Found, signal: Signal, search: Search, most: int, recordings: int) -> None:
    unit = signal.unit or ""
    unit = f" [{unit or '1'}/s]" if search.faster is not None else f" [{unit}]" if unit else ""
    rows = [
        (*([hit.recording] if recordings > 1 else []), moment_text(hit.begin),
         duration_text((hit.end - hit.begin) / HOUR),
         *([] if search.missing else [number_text(hit.lowest, 6), number_text(hit.highest, 6)]))
        for hit in hits.hits[:most]
    ]  # fmt: skip
    named = ["recording"] if recordings > 1 else []
    columns = (*named, "from", "for", *([] if search.missing else ["lowest" + unit, "highest" + unit]))
    if rows:
        out.print(f"{signal.name} {search}", style="bold", markup=False)
        print_table(out, table("", columns, rows, figures=range(len(named) + 1, len(columns))))
    where = f" in {recordings:,} recordings" if recordings > 1 else ""
    times = f"{hits.count:,} time{'s' * (hits.count != 1)}"
    out.print(f"Found {times}{where}, {duration_text(hits.length / HOUR)} in all", markup=False)
    if hits.count > len(rows):
        out.print(f"Listed are the first {len(rows):,}; --most lists more, --json up to {MOST_HITS:,}", markup=False)
    if hits.without and not search.missing:
        some = ", ".join(hits.without[:5]) + (" …" if len(hits.without) > 5 else "")
        out.print(f"{len(hits.without):,} without {signal.name}: {some}", markup=False)


def _found_json(
    hits: Found, signal: Signal, condition: Condition, age: int, each: Sequence[Recorded]
) -> dict[str, Any]:
    return {
        "signal": signal.name,
        "unit": signal.unit,
        "condition": asdict(condition),
        "gap": age,
        "recordings": [one.name for one in each],
        "without": hits.without,
        "count": hits.count,
        "length": hits.length,
        "hits": [hit._asdict() for hit in hits.hits],
        "notes": said(hits.notes),
    }


def summed_up(
    bags: Sequence[Path], names: Sequence[str], every: str | None, bins: int, gap: str, most: int,
    to: Path | None, report: Path | None, *, together: bool, force: bool, as_json: bool,
) -> None:  # fmt: skip
    """Print, and write where asked to, statistics of signals."""
    listed = every is not None and not as_json
    path = "statistics" + " of stretches of time (--every)" * listed + " that are written" * bool(to or report)
    refuse_unused(path, ("signal", "every", "bins", "gap", "together", "to", "report", *["force"] * bool(to or report),
                *["most"] * listed))  # fmt: skip
    may_make(to, *bags, *([report] if report else []), force=force, suffixes=(".csv",))
    may_make(report, *bags, force=force)
    age, step = max_age(gap), None if every is None else nanoseconds(every)
    if step is not None and step <= 0:
        raise RobophmError(f"--every {every}: expected a time above zero")
    each = recordings(bags, together=together)
    signals = [signal_of(name, each) for name in dict.fromkeys(names)]
    seen: list[Seen] = []
    kept: list[tuple[str, Signal, Window]] = []
    count, notes = 0, list[str]()
    with counted(progress_console(), "reading") as advance, _rows(to) as rows:
        for done, one in enumerate(each):
            advance(done, len(each))
            looks = {signal.name: Look.new(bins) for signal in signals}
            said_of: Counter[str] = Counter()
            for signal, window in statistics(one, signals, step, age, said_of, looks):
                count += 1
                if len(kept) < MOST_KEPT:
                    kept.append((one.name, signal, window))
                if rows:
                    rows.write(_csv_row(one.name, signal, window))
            notes += _named(one.name, said_of, several=len(each) > 1)
            for signal in signals:
                looks[signal.name].levels.finish()
                if looks[signal.name].whole.so_far:
                    seen.append(Seen(one.name, signal, looks[signal.name]))
    if report:
        write(report, statistics_page(seen, age, notes))
    if as_json:
        print_json({
            "gap": age, "every": step, "count": count, "notes": notes,
            "signals": [_seen_json(one) for one in seen],
            "windows": [_window_json(*one) for one in kept] if step else [],
        })  # fmt: skip
        return
    out = console()
    _print_seen(out, seen, several=len(each) > 1)
    if step:
        _print_windows(out, kept[:most], count, str(every), several=len(each) > 1)
    for written in filter(None, (to, report)):
        out.print(f"Written: {written}", markup=False)
    _warn_of(notes)


@contextmanager
def _rows(path: Path | None) -> Iterator[IO[bytes] | None]:
    """A table of windows being written."""
    if path is None:
        yield None
        return
    try:
        with replacing(path) as stream:
            stream.write(b"recording,signal,unit,begin,samples,known,lowest,mean,highest,deviation\n")
            yield stream
    except OSError as error:
        raise RobophmError(f"{path}: cannot be written: {error.strerror or error}") from None


def _csv_row(recording: str, signal: Signal, window: Window) -> bytes:
    begin, known = (f"{time // SECOND}.{time % SECOND:09d}" for time in (window.begin, window.held))
    figures = (window.lowest, window.mean, window.highest, window.deviation)
    quoted = '"' + recording.replace('"', '""') + '"'
    cells = (quoted, signal.name, signal.unit or "", begin, str(window.samples), known,
             *("" if math.isnan(one) else repr(one) for one in figures))  # fmt: skip
    return (",".join(cells) + "\n").encode("utf-8", "surrogateescape")


def _print_seen(out: Console, seen: Sequence[Seen], *, several: bool) -> None:
    if not seen:
        out.print("No samples.")
    columns = (*(["recording"] if several else []), "signal", "from", "known", "samples", "lowest", "mean", "highest",
               "deviation", "course")  # fmt: skip
    rows = []
    for one in seen:
        for window in one.look.whole.so_far:
            rows.append((*([one.recording] if several else []), one.signal.label, moment_text(window.begin)[:19],
                         *_figures(window), sparkline(one.look.series.means(20))))  # fmt: skip
    if rows:
        last = len(columns) - 1
        print_table(out, table("", columns, rows, figures=range(last - 6, last)))
    for one in seen:
        begins, hours = marginal(one.look.levels, 0)
        if hours.sum():
            where = f" in {one.recording}" if several else ""
            rows_of = level_rows(begins, hours, float(one.look.levels.widths[0]), one.signal.unit or "")
            print_levels(out, f"Time at level: {one.signal.name}{where}", rows_of)


def print_levels(out: Console, title: str, rows: Mapping[str, float]) -> None:
    """Shares of levels as bars."""
    top = max(rows.values(), default=0.0) or 1.0
    lines = [(name, f"{number_text(100 * share, 3)} %", bar_text(share / top)) for name, share in rows.items()]
    out.print(f"\n{title}", style="bold", markup=False)
    print_table(out, table("", ("level", "share", ""), lines, figures=(0, 1)))


def _print_windows(
    out: Console, kept: Sequence[tuple[str, Signal, Window]], count: int, every: str, *, several: bool
) -> None:
    columns = (*(["recording"] if several else []), "signal", "from", "known", "samples", "lowest", "mean", "highest",
               "deviation")  # fmt: skip
    rows = [
        (*([name] if several else []), signal.label, moment_text(window.begin)[:23], *_figures(window))
        for name, signal, window in kept
    ]
    last = len(columns)
    out.print(f"\nEvery {every}", style="bold", markup=False)
    print_table(out, table("", columns, rows, figures=range(last - 6, last)))
    if count > len(rows):
        out.print(f"Listed are the first {len(rows):,} of {count:,}; --most lists more, --to writes all", markup=False)


def _figures(window: Window) -> list[str]:
    figures = (window.lowest, window.mean, window.highest, window.deviation)
    return [duration_text(window.held / HOUR), f"{window.samples:,}", *map(number_text, figures)]


def _window_json(recording: str, signal: Signal, window: Window) -> dict[str, Any]:
    return {"recording": recording, "signal": signal.name, **asdict(window)}


def _seen_json(one: Seen) -> dict[str, Any]:
    (window,) = one.look.whole.so_far
    begins, hours = marginal(one.look.levels, 0)
    return {
        **_window_json(one.recording, one.signal, window),
        "unit": one.signal.unit,
        "levels": {"width": float(one.look.levels.widths[0]), "begin": begins.tolist(), "hours": hours.tolist()},
    }


def exported(bags: Sequence[Path], names: Sequence[str], to: Path, *, force: bool, as_json: bool) -> None:
    """Write samples as a table."""
    may_make(to, *bags, force=force, suffixes=SUFFIXES)
    (together,) = recordings(bags, together=True)
    signals = [signal_of(name, [together]) for name in dict.fromkeys(names)]
    notes: Counter[str] = Counter()
    with counted(progress_console(), "writing"):
        count = export(together, signals, to, notes)
    if as_json:
        columns = {signal.name: signal.unit for signal in signals}
        print_json({"file": str(to), "rows": count, "columns": columns, "notes": said(notes)})
        return
    console().print(f"Written: {to}, {count:,} rows of {len(signals)} signals", markup=False)
    _warn_of(said(notes))


def _named(name: str, notes: Counter[str], *, several: bool) -> list[str]:
    return [f"{name}: {note}" if several else note for note in said(notes)]


def _warn_of(notes: Sequence[str]) -> None:
    for note in notes:
        warn(note)
