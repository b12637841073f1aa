"""``python -m benchmarks [room | room.benchmark ...] [--json]``; exits with 1 where answers differ.

What a run has found is appended to series.jsonl, and the picture of the series drawn anew.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import time
from dataclasses import asdict
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec

from benchmarks import BENCHMARKS, ROOMS, DisagreementError, Line, seconds, series


def machine() -> dict[str, str | int]:
    return {
        "processor": series.processor(),
        "cores": os.cpu_count() or 0,
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
    } | {name: version(name) for name in ("numpy", "scipy", "rosbags", "repyability") if find_spec(name)}


def table(lines: list[Line]) -> str:
    """The lines as a Markdown table, aligned to be read as it stands."""
    rows = [("work", "ours", "peer", "ratio", "goal"), ("", "", "", "", "")]
    for line in lines:
        ours = seconds(line.ours) + (f" ({line.per_second})" if line.per_second else "")
        peer = f"{seconds(line.peer)} {line.peer_name}" if line.peer else "–"
        ratio = f"{line.ratio:.3g}" if line.ratio else "–"
        rows.append((line.work, ours, peer, ratio, f"≤ {line.goal:g}" if line.goal else "–"))
    widths = [max(len(row[i]) for row in rows) for i in range(5)]
    rows[1] = tuple("-" * width for width in widths)  # type: ignore[assignment]
    cells = ([cell.ljust(width) for cell, width in zip(row, widths, strict=True)] for row in rows)
    return "\n".join("| " + " | ".join(row) + " |" for row in cells)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description="speed against named peers")
    parser.add_argument("names", nargs="*", metavar="NAME", help="a room or a benchmark; default all")
    parser.add_argument("--json", action="store_true", help="machine and lines as JSON")
    arguments = parser.parse_args()
    for room in ROOMS:
        import_module(f"benchmarks.{room}")
    wanted = [name for name in BENCHMARKS if not arguments.names or {name, name.split(".")[0]} & set(arguments.names)]
    unknown = [n for n in arguments.names if not any(n in (name, name.split(".")[0]) for name in BENCHMARKS)]
    if unknown:
        parser.error(f"no benchmark {unknown[0]!r}; expected {', '.join((*ROOMS, *BENCHMARKS))}")

    lines: list[Line] = []
    differing: list[str] = []
    start, commit = time.monotonic(), series.commit()
    for name in wanted:
        print(name, end=" … ", file=sys.stderr, flush=True)
        try:
            lines += BENCHMARKS[name]()
        except DisagreementError as error:
            differing.append(f"{name}: {error}")
        print(f"{time.monotonic() - start:.0f} s", file=sys.stderr)

    if lines:
        series.append(series.run(lines, machine(), commit))
        series.main()
    if arguments.json:
        rows = [asdict(line) | {"ratio": line.ratio} for line in lines]
        print(json.dumps({"machine": machine(), "lines": rows, "differing": differing}, indent=1, ensure_ascii=False))
    else:
        print(table(lines), *(f"answers differ: {one}" for one in differing), sep="\n")
        print("\n" + ", ".join(f"{name} {value}" for name, value in machine().items()))
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
