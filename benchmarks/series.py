"""The course of the benchmarks: a line of series.jsonl for each run, and docs/benchmarks.svg drawn of all of them.

``python -m benchmarks`` appends a line and draws anew; ``python -m benchmarks.series`` only draws. Figures of different
processors do not compare, so each processor has a part of the picture to itself, with a small plot for each figure.
"""

from __future__ import annotations

import json
import math
import platform
import subprocess
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from benchmarks import Line, seconds
from robophm.report.markup import Html, element, shorten, text_width
from robophm.report.svg import svg, text
from robophm.report.words import number_text

ROOT = Path(__file__).resolve().parents[1]
SERIES = ROOT / "benchmarks" / "series.jsonl"
PICTURE = ROOT / "docs" / "benchmarks.svg"

Run = dict[str, Any]
"""A line of the series: date [UTC], commit, processor, cores, python, numpy, and figures; None is what nobody knows.

A figure has a name, ours with its unit, the peer, the ratio ours / peer, which has none, and the highest ratio that is
good enough. A run whose figures were not appended when it was made says by ``origin`` where they are from.
"""

COLUMNS, WIDE, HIGH, TOP = 4, 288, 138, 44  # of the picture; px
LEFT, RIGHT, UPPER, LOWER = 50, 272, 50, 118  # of a plot in its place; px
SIZE = 11.0  # of letters; px

STYLE = (
    f".series text{{font-size:{SIZE:g}px;fill:var(--ink)}}.series .quiet{{fill:var(--quiet)}}"
    ".series .head{font-size:15px;font-weight:600}.series .value{font-weight:600}"
    ".series .end{text-anchor:end}.series .missed{fill:var(--warn)}"
    ".series .grid{stroke:var(--edge)}.series .even{stroke:var(--line);stroke-width:1.6}"
    ".series .goal{stroke:var(--c1);stroke-dasharray:5 4}"
    ".series polyline{fill:none;stroke:var(--c0);stroke-width:1.4}.series circle{fill:var(--c0)}"
)


def processor() -> str:
    """The processor's name with its family and model, as virtual machines call many of them alike."""
    described = Path("/proc/cpuinfo")
    first = described.read_text(encoding="utf-8").partition("\n\n")[0] if described.exists() else ""
    said = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in first.splitlines())}
    name = said.get("model name") or platform.processor() or platform.machine()
    kinds = (f"{key} {said[key]}" for key in ("cpu family", "model", "CPU implementer", "CPU part") if key in said)
    return ", ".join([name, *kinds])


def commit(root: Path = ROOT) -> str | None:
    """The commit that is checked out, "-dirty" where sources differ from it; None where there is none."""

    def git(*words: str) -> str:
        return subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=False).stdout.strip()

    head = git("rev-parse", "--short=12", "HEAD")
    dirty = git("status", "--porcelain", "--", "src", "benchmarks", ":!benchmarks/series.jsonl")
    return (f"{head}-dirty" if dirty else head) or None


def run(lines: Sequence[Line], machine: Mapping[str, str | int], of: str | None) -> Run:
    """What a run that ends now has found of a commit."""
    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "commit": of,
        **{key: machine[key] for key in ("processor", "cores", "python", "numpy")},
        "figures": [
            {
                "name": line.work,
                "ours": float(f"{line.ours:.4g}"),
                "unit": "s",
                "peer": line.peer_name if line.peer else None,
                "ratio": line.ratio and float(f"{line.ratio:.4g}"),
                "goal": line.goal,
            }
            for line in lines
        ],
    }


def append(one: Run, series: Path = SERIES) -> None:
    with series.open("a", encoding="utf-8") as file:
        file.write(json.dumps(one, ensure_ascii=False) + "\n")


def read(series: Path = SERIES) -> list[Run]:
    """All runs, the oldest first."""
    lines = series.read_text(encoding="utf-8").splitlines() if series.exists() else []
    return sorted(map(json.loads, lines), key=lambda one: one["date"])


def picture(runs: Sequence[Run]) -> str:
    """The course of every figure as SVG, the processor of the last run first."""
    processors: dict[tuple[str, int], list[Run]] = {}
    for one in reversed(runs):
        processors.setdefault((one["processor"], one["cores"]), []).insert(0, one)
    told = (
        "Each plot is one figure over the runs, in their order: ours / peer on a logarithmic axis, less is faster. "
        "Thick: as fast as the peer. Dashed: the goal."
    )
    content, y = [text(8, 18, told, "quiet")], 44.0
    for (name, cores), its_runs in processors.items():
        ends = dict.fromkeys(f"{one['date'][:10]} {one['commit']}" for one in (its_runs[0], its_runs[-1]))
        counted = f"{_count(len(its_runs), 'run')}: {' to '.join(ends)}"
        origins = sorted({one["origin"] for one in its_runs if "origin" in one})
        content.append(text(8, y + 6, f"{name}, {_count(cores, 'core')}", "head"))
        content.append(text(8, y + 22, "; from ".join([counted, *origins]), "quiet"))
        y += TOP
        names = dict.fromkeys(
            (figure["name"], figure["peer"]) for one in reversed(its_runs) for figure in one["figures"]
        )
        for place, which in enumerate(names):
            plot = Html("\n".join(_plot(which, its_runs)))
            where = f"translate({place % COLUMNS * WIDE} {y + place // COLUMNS * HIGH:g})"
            content.append(element("g", plot, transform=where))
        y += math.ceil(len(names) / COLUMNS) * HIGH + 20
    return (
        svg(
            "series",
            content,
            title="The course of the benchmarks",
            description=told,
            style=STYLE,
            view=(0, 0, COLUMNS * WIDE, y),
            standalone=True,
        )
        + "\n"
    )


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _plot(which: tuple[str, str | None], runs: Sequence[Run]) -> Iterator[Html]:
    """One figure over the runs of a processor: the ratio, or ours where there is no peer."""
    name, peer = which
    found = [
        (place, one, figure)
        for place, one in enumerate(runs)
        for figure in one["figures"]
        if (figure["name"], figure["peer"]) == which
    ]
    key, say = ("ratio", lambda value: number_text(value, 3)) if peer else ("ours", seconds)
    values = [figure[key] for _, _, figure in found]
    goal = found[-1][2]["goal"] if peer else None
    shown = [*values, goal] if goal else values
    low = math.floor(math.log10(min(shown)))
    high = max(low + 1, math.ceil(math.log10(max(shown))))

    def height(value: float) -> float:
        return LOWER - (math.log10(value) - low) / (high - low) * (LOWER - UPPER)

    def across(kind: str, value: float) -> Html:
        return element("line", class_=kind, x1=LEFT, x2=RIGHT, y1=height(value), y2=height(value))

    lines = textwrap.wrap(name, 45, max_lines=2, placeholder=" …")
    missed = goal is not None and values[-1] > goal
    found_last = say(values[-1]) + (f" {'>' if missed else '≤'} {say(goal)}" if goal else "")
    room = RIGHT - 20 - text_width(found_last, SIZE, bold=True)
    yield element("title", f"{name}{f' / {peer}' if peer else ''}")
    yield from (text(8, 11 + 13 * i, line) for i, line in enumerate(lines))
    yield text(8, 11 + 13 * len(lines), shorten(f"/ {peer}", room, SIZE) if peer else "ours alone", "quiet")
    yield text(RIGHT, 11 + 13 * len(lines), found_last, "value end missed" if missed else "value end")
    for decade in range(low, high + 1):
        yield across("even" if peer and decade == 0 else "grid", 10.0**decade)
    yield from (text(LEFT - 5, height(10.0**decade) + 4, say(10.0**decade), "quiet end") for decade in (low, high))
    if goal:
        yield across("goal", goal)
    spots = [
        (LEFT + (place + 0.5) / len(runs) * (RIGHT - LEFT), height(figure[key]), one, figure[key])
        for place, one, figure in found
    ]
    yield element("polyline", points=" ".join(f"{x:.1f},{y:.1f}" for x, y, _, _ in spots))
    for x, y, one, value in spots:
        said = element("title", f"{one['date'][:10]} {one['commit']}: {say(value)}")
        yield element("g", said, element("circle", cx=x, cy=y, r=3))


def main() -> None:
    PICTURE.write_text(picture(read()), encoding="utf-8")


if __name__ == "__main__":
    main()
