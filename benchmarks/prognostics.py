"""``python -m benchmarks.prognostics [SET ...] [--peers] [--json]``: when wear ends, on machines that really wore out.

Each unit of a published set is looked at when a share λ of its life has gone by, and only what was read until then is
given. The true end is when readings first crossed the published threshold. For each set and λ the table has the median
of |median − truth| / truth and the share of stated 90 % intervals that held: alone, with the other units as teachers,
and for baselines: the straight line through all readings, and the mean life of the others less the age; with
``--peers`` SurPyval's path models with the others as prior. The data are not part of the project: ``../shared``.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError
from robophm.learning.wear.among_others import Unit, forecast_among
from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.health_index import SignalHistory, learn_health_index

Array = npt.NDArray[np.float64]
Interval = tuple[float, float, float]
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

    def limit(self, unit: str) -> float:
        return (self.others or {}).get(unit, self.threshold)


SETS = {
    "Virkler cracks": Set("virkler_crack", 49.8, (0.5, 0.7, 0.9)),
    "Alloy-A cracks to 1.6 in": Set("alloy_a_crack", 1.6, (0.5, 0.7, 0.9)),
    "Alloy-A cracks to 1.3 in": Set("alloy_a_crack", 1.3, (0.5, 0.7, 0.9)),
    "GaAs lasers to 5 %": Set("gaas_laser_current_increase", 5.0, (0.5, 0.7, 0.8)),
    "CALCE batteries": Set("calce_battery_capacity", 0.77, (0.5, 0.7, 0.9), True),
    "NASA batteries": Set("nasa_battery_capacity", 1.4, (0.5, 0.7, 0.9), True, {"B0007": 1.43}),
    "IMS bearing": Set("ims_test2_mean_abs_acceleration", 0.2, (0.7, 0.8, 0.9)),
    "FEMTO bearings": Set("femto_bearing_rms", 1.2, (0.7, 0.8, 0.9)),
}
ENGINES = "C-MAPSS FD001 engines"


@dataclass(frozen=True)
class Line:
    """What one way of foretelling reached on a set at one share of life."""

    set: str
    share: float
    way: str
    units: int
    error: float
    """Median of |median − truth| / truth; infinite where the median says never, nan where nothing is said."""
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


def straight(times: Array, values: Array, threshold: float) -> float:
    """What remains by the straight line of least squares."""
    slope, start = np.polyfit(times, values, 1)
    at = (threshold - start) / slope if slope else math.inf
    return float(max(at - times[-1], 0.0)) if at > 0 else math.inf


def surpyval(one: Set, units: Mapping[str, Readings]) -> Callable[[str, Array, Array], Interval]:
    """SurPyval's Bayesian prediction by the path that its AICc chooses for the other units."""
    from surpyval.degradation import DegradationAnalysis

    chosen: list[str] = []

    def ask(unit: str, t: Array, y: Array) -> Interval:
        rest = {name: known for name, known in units.items() if name != unit}
        x, z = (np.concatenate([known[k] for known in rest.values()]) for k in (0, 1))
        i = np.repeat(list(rest), [len(known[0]) for known in rest.values()])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            fitted = DegradationAnalysis.fit(x, z, i, one.limit(unit), path=chosen[0] if chosen else "best")
            if not chosen:
                chosen.append(str(fitted.path_model.name))
            found = fitted.predict_rul(t, y, alpha_ci=0.1, random_state=0, n_samples=2000)
        low, high = found.rul_interval
        return float(low), float(found.rul), float(high)

    return ask


def ways(one: Set, units: Mapping[str, Readings], *, peers: bool) -> dict[str, Callable[[str, Array, Array], Interval]]:
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

    found = {"alone": alone, "with the others": among, "straight line": line, "mean life": mean_life}
    return found | ({"SurPyval": surpyval(one, units)} if peers else {})


def lines_of(name: str, *, peers: bool) -> Iterator[Line]:
    """All lines of one set of cracks, lasers, batteries or bearings."""
    one, units = SETS[name], readings(SETS[name].file)
    ends = {unit: crossing(*known, one.limit(unit), falls=one.falls) for unit, known in units.items()}
    for share in one.shares:
        for way, ask in ways(one, units, peers=peers).items():
            off, held, wide, start = [], [], [], time.perf_counter()
            for unit, end in ends.items():
                if end is None:
                    continue
                t, y = (part[units[unit][0] <= share * end] for part in units[unit])
                truth = end - float(t[-1])
                try:
                    low, median, high = ask(unit, t, y)
                except (DataError, ValueError, np.linalg.LinAlgError):
                    low, median, high = math.nan, math.inf, math.nan
                off.append(abs(median - truth) / truth)
                held.append(low <= truth <= high)
                wide.append((high - low) / truth)
            stated = not all(math.isnan(one) for one in wide)
            yield Line(
                name, share, way, len(off), float(np.median(off)), float(np.mean(held)) if stated else None,
                float(np.median(wide)) if stated else None, (time.perf_counter() - start) / len(off),
            )  # fmt: skip


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
    return f"{value:.2f}" if math.isfinite(value) else "never"


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.prognostics", description="when real wear ends")
    parser.add_argument("sets", nargs="*", metavar="SET", help="the start of a set's name; default all")
    parser.add_argument("--peers", action="store_true", help="SurPyval beside us")
    parser.add_argument("--json", action="store_true", help="a line of JSON a line of the table")
    asked = parser.parse_args()
    if not DATA.is_dir():
        print(f"{DATA} is not here: run beside the data, which are not part of the project", file=sys.stderr)
        return 2

    def wanted(name: str) -> bool:
        return not asked.sets or any(name.lower().startswith(one.lower()) for one in asked.sets)

    if not asked.json:
        print("| set | λ | by | units | error | held | width | s a unit |\n|---|---|---|---|---|---|---|---|")
    for name in filter(wanted, SETS):
        for line in lines_of(name, peers=asked.peers):
            if asked.json:
                print(json.dumps(asdict(line)), flush=True)
                continue
            error, held, width = (_figure(one) for one in (line.error, line.held, line.width))
            print(
                f"| {name} | {line.share:g} | {line.way} | {line.units} | {error} | {held} | {width} "
                f"| {line.seconds:.2f} |", flush=True,
            )  # fmt: skip
    if wanted(ENGINES):
        if not asked.json:
            print("\n| set | by | engines | RMSE | score | held | s to learn |\n|---|---|---|---|---|---|---|")
        for way, count, error, score, share, took in engines():
            if asked.json:
                said = {"set": ENGINES, "way": way, "units": count, "rmse": error, "score": score, "held": share}
                print(json.dumps(said), flush=True)
            else:
                stated = "–" if share is None else f"{share:.2f}"
                print(
                    f"| {ENGINES} | {way} | {count} | {error:.1f} | {score:.0f} | {stated} | {took:.1f} |", flush=True
                )
    return 0


if __name__ == "__main__":
    sys.exit(main())
