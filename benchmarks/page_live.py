"""20 series of 50 values a second over a window of 30 s, on our page and on one of Panel and Bokeh, in Chromium.

``python -m benchmarks.page_live [ROUNDS]`` (extra ``bench``; three rounds take four minutes): both services read the
same file at the pace at which it was recorded; the browsers look in turns, each for 10 s once its window is full.
Then four browsers look at ours at once. The bytes of the first load, frames (by requestAnimationFrame), and what all
processes of the browser, and the service, took of the processor, as the kernel counts it. Ours draws hazard rate,
reliability and completion besides.
"""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

SERIES, RATE, WINDOW = 20, 50, 30.0
LOOK = 10.0
"""Seconds that are measured."""
SLOW = 34.0
"""[ms] that a frame should not take."""
SETTLING = 6.0
FLAGS = ["--no-sandbox", "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--no-first-run", "--disable-gpu"]  # fmt: skip
FRAMES = """(seconds) => new Promise((resolve) => {
  const times = [];
  const step = (now) => {
    times.push(now);
    times[0] + seconds * 1000 > now ? requestAnimationFrame(step) : resolve(times);
  };
  requestAnimationFrame(step);
})"""

PANEL = f"""
import bisect, csv, sys, time
import panel
from bokeh.models import ColumnDataSource
from bokeh.palettes import Category20
from bokeh.plotting import figure

rows = [[float(cell) for cell in row] for row in list(csv.reader(open(sys.argv[1])))[1:]]
times, names = [row[0] for row in rows], ["y%d" % i for i in range({SERIES})]
begun, offset = float(sys.argv[3]), times[0]
so_far = lambda: bisect.bisect(times, offset + time.time() - begun)

def columns(part):
    return {{"x": [1000 * row[0] for row in part], **{{n: [row[i + 1] for row in part] for i, n in enumerate(names)}}}}

def page():
    sent = [so_far()]
    source = ColumnDataSource(columns(rows[max(0, sent[0] - {round(RATE * WINDOW)}):sent[0]]))
    plot = figure(width=490, height=230, x_axis_type="datetime", toolbar_location=None)
    for name, colour in zip(names, Category20[20]):
        plot.line("x", name, source=source, color=colour)
    plot.x_range.follow, plot.x_range.follow_interval = "end", {1000 * WINDOW}
    def more():
        now = so_far()
        if now > sent[0]:
            source.stream(columns(rows[sent[0]:now]), rollover={round(RATE * WINDOW)})
            sent[0] = now
    panel.state.add_periodic_callback(more, period=100)
    return panel.Column("# Live", panel.pane.Bokeh(plot))

print("ready", flush=True)
panel.serve(page, port=int(sys.argv[2]), address="127.0.0.1", show=False, title="Live")
"""


class Looked(NamedTuple):
    """What was seen in one look."""

    frames: int
    longest: float
    """[ms]"""
    slow: int
    browser: float
    """Share of a core."""
    service: float


def write_data(folder: Path, seconds: float) -> tuple[Path, Path]:
    """A recording, and a robot that listens to it."""
    signals = [f"/part_{i}/temperature.temperature" for i in range(SERIES)]
    data, design = folder / "data.csv", folder / "robot.yaml"
    with data.open("w") as stream:
        stream.write(",".join(["time", *signals]) + "\n")
        for row in range(round(seconds * RATE)):
            at = row / RATE
            values = (40 + i + 3 * math.sin(at * (0.3 + i / 10)) + math.sin(997 * at + i) / 3 for i in range(SERIES))
            stream.write(",".join([f"{1_700_000_000 + at:.3f}", *(f"{value:.4f}" for value in values)]) + "\n")
    lines = ["schema_version: 1", "name: twenty", "acceleration: {model: q10, reference_temperature: 25 degC}"]
    lines += ["task: {duration: 1 h}", "components:"]
    for i in range(SERIES):
        bound = f"{{topic: /part_{i}/temperature, field: temperature, range: [-40, 125]}}"
        lines.append(f"  part {i}: {{rate: {i + 1} FPMH, signals: {{temperature: {bound}}}}}")
    design.write_text("\n".join(lines) + "\n")
    return data, design


def processes(root: int) -> set[int]:
    """A process and all below it."""
    parents = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            parents[int(folder.name)] = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
        except (OSError, ValueError):
            continue
    found = {root}
    while more := {one for one, parent in parents.items() if parent in found} - found:
        found |= more
    return found


def taken(pids: set[int]) -> float:
    """Processor time of processes so far [s]."""
    ticks = 0
    for pid in pids:
        try:
            ticks += sum(map(int, Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:13]))
        except OSError:
            continue
    return ticks / os.sysconf("SC_CLK_TCK")


@contextmanager
def running(*words: str, ready: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A service, and the line in which it said that it is ready."""
    process = subprocess.Popen([sys.executable, "-u", *words], stdout=subprocess.PIPE, text=True)
    assert process.stdout
    try:
        line = next((line for line in process.stdout if ready in line), None)
        if line is None:
            raise SystemExit(f"{' '.join(words[:4])} ended before it was ready")
        yield process, line
    finally:
        process.terminate()
        process.wait(timeout=30)


def open_page(context: Any, address: str) -> Any:
    """The page of one of them, drawing."""
    page = context.new_page()
    page.goto(address)
    if "#" in address:
        page.get_by_label("Window").select_option("30")
        page.locator(".plot", has_text="Sensors in degC").locator("canvas").wait_for()
    else:
        page.locator("canvas").first.wait_for(timeout=60_000)
    return page


def look(playwright: Any, address: str, service: int, pages: int = 1) -> tuple[Looked, int]:
    """One look by so many browsers; and the bytes of the first load."""
    before = processes(os.getpid())
    browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
    sizes: list[float] = []
    try:
        opened = []
        for _ in range(pages):
            context = browser.new_context(viewport={"width": 1280, "height": 1500})
            first = context.new_page()
            session = context.new_cdp_session(first)
            session.send("Network.enable")
            session.on("Network.loadingFinished", lambda event: sizes.append(event["encodedDataLength"]))
            first.goto(address)
            first.wait_for_timeout(1000)
            first.close()
            opened.append(open_page(context, address))
        loaded = sum(sizes) / pages
        time.sleep(SETTLING)
        mine = processes(os.getpid()) - before - processes(service)
        begun, browsing, serving = time.monotonic(), taken(mine), taken({service})
        times = opened[0].evaluate(FRAMES, LOOK)
        took = time.monotonic() - begun
        shares = (taken(mine) - browsing) / took, (taken({service}) - serving) / took
    finally:
        browser.close()
    steps = [later - earlier for earlier, later in pairwise(times)]
    return Looked(len(steps), max(steps), sum(step > SLOW for step in steps), *shares), round(loaded)


def main(rounds: int = 3) -> int:
    from playwright.sync_api import sync_playwright

    seconds = 60 + rounds * 60 + 60
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        folder = Path(name)
        data, design = write_data(folder, seconds)
        (folder / "panel_page.py").write_text(PANEL)
        serve = (
            "-m",
            "robophm",
            "serve",
            str(design),
            "--port",
            "8790",
            "--replay",
            str(data),
            "--start",
            "recordings",
        )
        with running(*serve, ready="http") as (ours, said):
            panel_words = (str(folder / "panel_page.py"), str(data), "8791", str(time.time()))
            with running(*panel_words, ready="ready") as (theirs, _):
                addresses = {
                    "robophm": (re.findall(r"http[^ ]*/", said)[0] + "#/live", ours.pid),
                    "Panel": ("http://127.0.0.1:8791/", theirs.pid),
                }  # fmt: skip
                time.sleep(WINDOW + 2)
                looks: dict[str, list[Looked]] = {one: [] for one in addresses}
                loads = {}
                for turn in range(rounds):
                    for one in sorted(addresses, reverse=turn % 2 == 1):
                        found, loads[one] = look(playwright, *addresses[one])
                        looks[one].append(found)
                        print(one, found, file=sys.stderr, flush=True)
                four, _ = look(playwright, *addresses["robophm"], pages=4)
    report(looks, loads, four)
    return 0


def report(looks: dict[str, list[Looked]], loads: dict[str, int], four: Looked) -> None:
    """A table, medians of the rounds."""

    def middle(one: str, field: str) -> float:
        return statistics.median(getattr(found, field) for found in looks[one])

    rows = [
        ("frames a second", *(f"{middle(one, 'frames') / LOOK:.1f}" for one in looks), "–"),
        (f"frames over {SLOW:g} ms in {LOOK:g} s, each round",
         *(", ".join(str(found.slow) for found in looks[one]) for one in looks), "0"),
        ("longest frame, each round [ms]",
         *(", ".join(f"{found.longest:.0f}" for found in looks[one]) for one in looks), "–"),
        ("browser, share of a core", *(f"{100 * middle(one, 'browser'):.0f} %" for one in looks),
         f"≤ 0.8 of Panel's: {middle('robophm', 'browser') / middle('Panel', 'browser'):.2f}"),
        ("service, share of a core", *(f"{100 * middle(one, 'service'):.1f} %" for one in looks), "–"),
        ("service with four browsers", f"{100 * four.service:.1f} %", "–", "≤ 5 %"),
        ("first load, compressed where it is [kB]", *(f"{loads[one] / 1000:.0f}" for one in looks), "≤ 150"),
    ]  # fmt: skip
    print(f"| {SERIES} series, {RATE} Hz, {WINDOW:g} s, {len(looks['robophm'])} rounds | {' | '.join(looks)} | goal |")
    print("| --- | --- | --- | --- |")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print(json.dumps({"looks": looks, "four": four, "loads": loads}), file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
