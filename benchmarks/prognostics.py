"""``python -m benchmarks.prognostics [SET ...] [--peers] [--json]``: when wear ends, on machines that really wore out.

Each unit of a published set is looked at when a share λ of its life has gone by, and only what was read until then is
given. The true end is when readings first crossed the published threshold. Entries are the median of |median − truth|
/ truth where a life was said, the share of stated 90 % intervals that held, and their median width over the truth:
alone, with the other units as teachers, and for baselines: the straight line through all readings, and the mean life of
the others less the age; with ``--peers`` others beside us (``prognostics_peers.py``). Bearings are looked at once more
at shares of the time since their damage showed, as far as any of them shows. Then the IEEE PHM 2012
challenge's score on its training bearings, cut as it cut its own; Meeker and Escobar's Device-B, from accelerated tests
to the temperature of use; and NASA's engines. The data are not part of the project: ``../shared``.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from scipy import optimize

from benchmarks.prognostics_peers import Array, Asked, Interval, progpy, surpyval
from robophm.core.errors import DataError
from robophm.hazard.acceleration import ABSOLUTE_ZERO, BOLTZMANN
from robophm.learning.wear.among_others import Unit, forecast_among
from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.conditions import life_under
from robophm.learning.wear.health_index import SignalHistory, learn_health_index
from robophm.learning.wear.since_onset import onset

Readings = tuple[Array, Array]

DATA = Path(__file__).parents[2] / "shared/degradation"


@dataclass(frozen=True)
class Set:
    """Units that wore out, and what they are asked."""

    file: str
    threshold: float
    shares: tuple[float, ...]
    falls: bool = False
    others: Mapping[str, float] | None = None
    """Units with a threshold of their own."""
    since_damage: bool = False
    """Whether shares are of the time since damage showed, in place of the life; units that show none are left out."""

    def limit(self, unit: str) -> float:
        return (self.others or {}).get(unit, self.threshold)


SINCE_DAMAGE = (0.0, 0.25, 0.5, 0.75)
SETS = {
    "Virkler cracks": Set("virkler_crack", 49.8, (0.5, 0.7, 0.9)),
    "Alloy-A cracks to 1.6 in": Set("alloy_a_crack", 1.6, (0.5, 0.7, 0.9)),
    "Alloy-A cracks to 1.3 in": Set("alloy_a_crack", 1.3, (0.5, 0.7, 0.9)),
    "GaAs lasers to 5 %": Set("gaas_laser_current_increase", 5.0, (0.5, 0.7, 0.8)),
    "CALCE batteries": Set("calce_battery_capacity", 0.77, (0.5, 0.7, 0.9), True),
    "NASA batteries": Set("nasa_battery_capacity", 1.4, (0.5, 0.7, 0.9), True, {"B0007": 1.43}),
    "IMS bearing": Set("ims_test2_mean_abs_acceleration", 0.2, (0.5, 0.7, 0.8, 0.9)),
    "FEMTO bearings": Set("femto_bearing_rms", 1.2, (0.5, 0.7, 0.8, 0.9, 0.98)),
    "IMS bearing, since damage showed": Set("ims_test2_mean_abs_acceleration", 0.2, SINCE_DAMAGE, since_damage=True),
    "FEMTO bearings, since damage showed": Set("femto_bearing_rms", 1.2, SINCE_DAMAGE, since_damage=True),
}
ENGINES, CHALLENGE, DEVICES = "C-MAPSS FD001, engines 1 to 50", "PHM 2012, training bearings", "Device-B at 80 °C"
DAMAGED = "PHM 2012, training bearings since damage showed"
CHALLENGE_SHARES = (0.61, 0.66, 0.75, 0.76, 0.81, 0.81, 0.82, 0.87, 0.93, 0.94, 0.97)
"""Of their lives, at which the challenge cut its eleven test bearings (its printed times left, over all lives)."""
USE, LIMIT = 80.0, -0.5
"""Temperature of use [°C] and threshold [dB] of Device-B (Meeker and Escobar 1998)."""


@dataclass(frozen=True)
class Line:
    """What one way of foretelling reached on a set at one share of life."""

    set: str
    share: float
    way: str
    units: int
    said: int
    """Of these, for how many a life was said."""
    error: float
    """Median of |median − truth| / truth of these; infinite where none was said."""
    held: float | None
    """Share of 90 % intervals that held; None where none is stated."""
    width: float | None
    """Median width of intervals over the true remaining life."""
    seconds: float
    """A unit."""


def readings(file: str) -> dict[str, Readings]:
    """Units of a table ``unit,time,value``."""
    units: dict[str, list[tuple[float, float]]] = {}
    with (DATA / f"{file}.csv").open() as table:
        for row in csv.DictReader(table):
            units.setdefault(row["unit"], []).append((float(row["time"]), float(row["value"])))
    return {name: (np.array([t for t, _ in rows]), np.array([y for _, y in rows])) for name, rows in units.items()}


def crossing(times: Array, values: Array, threshold: float, *, falls: bool) -> float | None:
    """When readings first crossed a threshold, between two of them."""
    sign = -1 if falls else 1
    over = np.flatnonzero(sign * values >= sign * threshold)
    if not len(over):
        return None
    if (k := int(over[0])) == 0:
        return float(times[0])
    share = (threshold - values[k - 1]) / (values[k] - values[k - 1])
    return float(times[k - 1] + share * (times[k] - times[k - 1]))


def showed(times: Array, values: Array, threshold: float, end: float) -> float | None:
    """Since when damage showed that led to its end, on a signal that rises; None where it did not, or early."""
    known = times < end
    return onset(times[known], (values[known] - values[0]) / (threshold - values[0]))


def straight(times: Array, values: Array, threshold: float) -> float:
    """What remains by the straight line of least squares."""
    slope, start = np.polyfit(times, values, 1)
    at = (threshold - start) / slope if slope else math.inf
    return float(max(at - times[-1], 0.0)) if at > 0 else math.inf


def ways(one: Set, units: Mapping[str, Readings], *, peers: bool) -> dict[str, Asked]:
    """What foretells, by name: of a unit and its readings so far; nan where it states no interval."""

    def alone(unit: str, t: Array, y: Array) -> Interval:
        return forecast(t, y, one.limit(unit), falls=one.falls).remaining

    def among(unit: str, t: Array, y: Array) -> Interval:
        others = [Unit(*units[name], one.limit(name)) for name in units if name != unit]
        return forecast_among(others, t, y, one.limit(unit), falls=one.falls).remaining

    def line(unit: str, t: Array, y: Array) -> Interval:
        return math.nan, straight(t, y, one.limit(unit)), math.nan

    def mean_life(unit: str, t: Array, y: Array) -> Interval:
        ends = [crossing(*units[name], one.limit(name), falls=one.falls) for name in units if name != unit]
        known = [end for end in ends if end is not None]
        return math.nan, max(float(np.mean(known)) - float(t[-1]), 0.0) if known else math.nan, math.nan

    found: dict[str, Asked] = {
        "alone": alone, "with the others": among, "straight line": line, "mean life": mean_life
    }  # fmt: skip
    if peers:
        limits = {name: one.limit(name) for name in units}
        found["SurPyval"] = surpyval(limits, units)
        if particles := progpy(limits, falls=one.falls):
            found["progpy"] = particles
    return found


def lines_of(name: str, *, peers: bool) -> Iterator[Line]:
    """All lines of one set of cracks, lasers, batteries or bearings."""
    one, units = SETS[name], readings(SETS[name].file)
    ends = {unit: crossing(*known, one.limit(unit), falls=one.falls) for unit, known in units.items()}
    begun: dict[str, float | None] = dict.fromkeys(units, 0.0)
    if one.since_damage:
        begun = {unit: showed(*units[unit], one.limit(unit), end) if end else None for unit, end in ends.items()}
    for share in one.shares:
        for way, ask in ways(one, units, peers=peers).items():
            off, held, wide, start = [], [], [], time.perf_counter()
            for unit, end in ends.items():
                if end is None or (start_at := begun[unit]) is None:
                    continue
                t, y = (part[units[unit][0] <= start_at + share * (end - start_at)] for part in units[unit])
                truth = end - float(t[-1])
                try:
                    low, median, high = ask(unit, t, y)
                except (DataError, ValueError, np.linalg.LinAlgError):
                    low, median, high = math.nan, math.inf, math.nan
                off.append(abs(median - truth) / truth)
                held.append(low <= truth <= high)
                wide.append((high - low) / truth)
            said = [one for one in off if math.isfinite(one)]
            stated = not all(math.isnan(one) for one in wide)
            yield Line(
                name, share, way, len(off), len(said), float(np.median(said)) if said else math.inf,
                float(np.mean(held)) if stated else None, float(np.median(wide)) if stated else None,
                (time.perf_counter() - start) / len(off),
            )  # fmt: skip


def challenge(*, since_damage: bool = False) -> Iterator[tuple[str, int, float, float, float]]:
    """PHM 2012 on its training bearings: way, cuts, mean score, median error, share of 90 % intervals that held.

    ``since_damage``: cut at shares of the time since damage showed, in place of the challenge's.
    """
    units = readings(SETS["FEMTO bearings"].file)
    scores: dict[str, list[float]] = {"median": [], "point of the best expected score": [], "mean life": []}
    off, held = [], []
    for name, (t, y) in units.items():
        rest = {other: known for other, known in units.items() if other != name}
        limit = float(np.median([np.median(known[1][-5:]) for known in rest.values()]))
        others = [Unit(*known, limit, failed=float(known[0][-1])) for known in rest.values()]
        began = showed(t, y, limit, float(t[-1])) if since_damage else 0.0
        for share in SINCE_DAMAGE if since_damage else CHALLENGE_SHARES:
            if began is None:
                continue
            seen = t <= began + share * (t[-1] - began)
            truth = float(t[-1] - t[seen][-1])
            said = forecast_among(others, t[seen], y[seen], limit)
            median, drawn = said.remaining.median, said.passage[np.isfinite(said.passage)]
            points = np.quantile(drawn, np.linspace(0.02, 0.6, 59))
            best = float(points[np.argmax([np.mean(challenge_score(drawn, point)) for point in points])])
            mean = max(float(np.mean([known[0][-1] for known in rest.values()]) - t[seen][-1]), 0.0)
            for way, point in zip(scores, (median, best, mean), strict=True):
                scores[way].append(float(challenge_score(np.array([truth]), point)[0]))
            off.append(abs(median - truth) / truth)
            held.append(said.remaining.low <= truth <= said.remaining.high)
    for way, found in scores.items():
        yield way, len(found), float(np.mean(found)), float(np.median(off)), float(np.mean(held))


def challenge_score(truth: Array, said: float) -> Array:
    """The challenge's: of the error in per cent of the truth, early halves it each 20, late each 5. Shape of truth."""
    percent = 100 * (truth - said) / np.maximum(truth, 1e-9)
    result: Array = np.exp2(np.where(percent <= 0, percent / 5, -percent / 20))
    return result


def device_b() -> Iterator[tuple[str, float, float, float]]:
    """Device-B, -0.5 dB at 80 °C: way, 5 %, median, 95 % of lives [h]."""
    rows: dict[str, list[tuple[float, float, float]]] = {}
    with (DATA / "device_b_power_drop.csv").open() as table:
        for row in csv.DictReader(table):
            rows.setdefault(row["device"], []).append(
                (float(row["hours"]), float(row["powerdrop"]), float(row["celsius"]))
            )
    devices = [tuple(np.array(column) for column in zip(*known, strict=True)) for known in rows.values()]
    units = [Unit(t, y, conditions={"temperature": celsius}) for t, y, celsius in devices]
    low, median, high = np.quantile(life_under({"temperature": USE}, units, LIMIT, falls=True), [0.05, 0.5, 0.95])
    yield "lives under conditions", float(low), float(median), float(high)
    yield "path model, by least squares", math.nan, least_squares(devices), math.nan


def least_squares(devices: Sequence[tuple[Array, ...]]) -> float:
    """Median life by the book's path, D·(1 − exp(−R·t)) with ln R straight in 1/kT, all devices with one D."""
    inverse = np.array([1 / (BOLTZMANN * (celsius[0] - ABSOLUTE_ZERO)) for _, _, celsius in devices])

    def off(at: Array) -> Array:
        logs = at[1] - at[2] * (inverse - inverse.mean()) + at[3:]
        away = [y + np.exp(at[0]) * -np.expm1(-np.exp(r) * t) for (t, y, _), r in zip(devices, logs, strict=True)]
        return np.concatenate([*away, 0.05 * at[3:]])

    found = optimize.least_squares(off, np.concatenate([[0.3, -8.0, 0.7], np.zeros(len(devices))])).x
    rate = math.exp(found[1] - found[2] * (1 / (BOLTZMANN * (USE - ABSOLUTE_ZERO)) - inverse.mean()))
    return -math.log(1 + LIMIT / math.exp(found[0])) / rate


def engines() -> Iterator[tuple[str, int, float, float, float | None, float]]:
    """FD001: way, engines, RMSE (with lives capped at 125, as is usual), PHM score, held 90 %, seconds to learn."""

    def table(file: str) -> dict[int, Array]:
        rows = np.genfromtxt(DATA / file, delimiter=",", skip_header=1)
        return {int(unit): rows[rows[:, 0] == unit][:, 1:] for unit in np.unique(rows[:, 0])}

    failed, running = table("cmapss_fd001_train.csv"), table("cmapss_fd001_test_1_50.csv")
    with (DATA / "cmapss_fd001_rul_1_50.csv").open() as rows:
        truth = np.array([float(row["rul"]) for row in csv.DictReader(rows)])
    start = time.perf_counter()
    index = learn_health_index([SignalHistory(one[:, 0], one[:, 1:]) for one in failed.values()], horizon=125.0)
    took = time.perf_counter() - start
    said = [index.remaining(one[:, 0], one[:, 1:]) for one in running.values()]
    held = float(np.mean([one.interval[0] <= end <= one.interval[2] for one, end in zip(said, truth, strict=True)]))
    lives = np.array([len(one) for one in failed.values()])
    age = np.array([len(one) for one in running.values()])
    by_age = np.array([float(np.mean(lives[lives > known] - known)) for known in age])
    for way, point, share in (
        ("health index", np.array([one.index for one in said]), held),
        ("median of the interval", np.array([one.interval[1] for one in said]), held),
        ("mean of those that grew as old", by_age, None),
    ):
        off = np.minimum(point, 125.0) - np.minimum(truth, 125.0)
        score = float(np.sum(np.where(off < 0, np.expm1(-off / 13), np.expm1(off / 10))))
        yield way, len(truth), float(np.sqrt(np.mean(off**2))), score, share, took


def _figure(value: float | None) -> str:
    if value is None or math.isnan(value):
        return "–"
    return f"{value:.2f}" if math.isfinite(value) else "open"


def _entry(line: Line) -> str:
    """Error, held and width; how many were said, where not all."""
    if not line.said:
        text = "not said" if line.held is None else f"not said / {line.held:.2f}"
    elif line.held is None:
        text = _figure(line.error)
    else:
        text = f"{_figure(line.error)} / {line.held:.2f} / {_figure(line.width)}"
    return text if line.said in (0, line.units) else f"{text} ({line.said} said)"


def print_sets(names: Sequence[str], *, peers: bool, as_json: bool) -> None:
    columns: list[str] = []
    slowest: dict[str, float] = {}
    for name in names:
        row: list[Line] = []
        for line in lines_of(name, peers=peers):
            if as_json:
                print(json.dumps(asdict(line)), flush=True)
                continue
            if row and line.share != row[0].share:
                _print_row(row, columns)
                row = []
            row.append(line)
            slowest[line.way] = max(slowest.get(line.way, 0.0), line.seconds)
        if row:
            _print_row(row, columns)
    if slowest:
        print("\nSeconds a unit at most: " + ", ".join(f"{way} {took:.2f}" for way, took in slowest.items()))


def _print_row(row: Sequence[Line], columns: list[str]) -> None:
    if not columns:
        columns += [line.way for line in row]
        print("| set | λ | units | " + " | ".join(columns) + " |\n" + "|---" * (3 + len(columns)) + "|")
    found = {line.way: _entry(line) for line in row}
    entries = " | ".join(found.get(way, "–") for way in columns)
    print(f"| {row[0].set} | {row[0].share:g} | {row[0].units} | {entries} |", flush=True)


def print_challenge(name: str, *, as_json: bool) -> None:
    if not as_json:
        print(f"\n| {name} | cuts | mean score | error of the median | 90 % held |\n|---|---|---|---|---|")
    for way, cuts, score, off, held in challenge(since_damage=name == DAMAGED):
        if as_json:
            print(json.dumps({"set": name, "way": way, "cuts": cuts, "score": score, "error": off, "held": held}))
        else:
            median = way == "median"
            print(f"| {way} | {cuts} | {score:.2f} | {_figure(off if median else None)} "
                  f"| {_figure(held if median else None)} |", flush=True)  # fmt: skip


def print_devices(*, as_json: bool) -> None:
    if not as_json:
        print(f"\n| {DEVICES}, life to −0.5 dB | 5 % | median | 95 % [1000 h] |\n|---|---|---|---|")
    for way, *lives in device_b():
        if as_json:
            print(json.dumps({"set": DEVICES, "way": way, "quantiles": lives}))
        else:
            print(f"| {way} | " + " | ".join("–" if math.isnan(one) else f"{one / 1000:.0f}" for one in lives) + " |")


def print_engines(*, as_json: bool) -> None:
    if not as_json:
        print(f"\n| {ENGINES} | RMSE, capped at 125 | PHM score | 90 % held | s to learn |\n|---|---|---|---|---|")
    for way, count, error, score, share, took in engines():
        if as_json:
            said = {"set": ENGINES, "way": way, "units": count, "rmse": error, "score": score, "held": share}
            print(json.dumps(said), flush=True)
        else:
            print(f"| {way} | {error:.1f} | {score:.0f} | {_figure(share)} | {took:.0f} |", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.prognostics", description="when real wear ends")
    parser.add_argument("sets", nargs="*", metavar="SET", help="the start of a set's name; default all")
    parser.add_argument("--peers", action="store_true", help="SurPyval and progpy beside us")
    parser.add_argument("--json", action="store_true", help="a line of JSON a line of the table")
    asked = parser.parse_args()
    if not DATA.is_dir():
        print(f"{DATA} is not here: run beside the data, which are not part of the project", file=sys.stderr)
        return 2

    def wanted(name: str) -> bool:
        return not asked.sets or any(name.lower().startswith(one.lower()) for one in asked.sets)

    print_sets(list(filter(wanted, SETS)), peers=asked.peers, as_json=asked.json)
    for name in filter(wanted, (CHALLENGE, DAMAGED)):
        print_challenge(name, as_json=asked.json)
    for name, shown in ((DEVICES, print_devices), (ENGINES, print_engines)):
        if wanted(name):
            shown(as_json=asked.json)
    return 0


if __name__ == "__main__":
    sys.exit(main())
