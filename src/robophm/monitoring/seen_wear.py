"""The wear of a robot by the readings in its ledger: forecasts by degradation models, and changes of its signals.

A forecast takes up to a second: each is made once for the same readings, and where there is no time for it, beside what
runs (``wear_watch.py``).
"""

from __future__ import annotations

import math
import threading
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from robophm.core.errors import DataError
from robophm.design.robot import CLOCK_UNITS, FailureMode, Robot
from robophm.design.wear_signal import WearSignal
from robophm.health.foretold_life import ForetoldLife
from robophm.health.ledger import Ledger
from robophm.health.wear_readings import WearCourse, WearReadings
from robophm.health.worn import SeenWear, WearAlarm, WearState
from robophm.learning.wear.alarm_episodes import episodes
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.readings_table import Readings
from robophm.learning.wear.stated_life import StatedLife
from robophm.learning.wear.teachers import teachers_of
from robophm.learning.wear.worn_mode import WearOptions, WornMode, changes_in, worn_mode

KEPT = 256
"""Forecasts that are kept, and detectors of change."""

_forecasts: OrderedDict[tuple[object, ...], SeenWear] = OrderedDict()
_lock = threading.Lock()


def seen_wear(robot: Robot, ledger: Ledger, others: Mapping[str, Sequence[Unit]] | None = None) -> tuple[SeenWear, ...]:
    """Return the wear of every failure mode whose signal was read, in design order; it depends on readings alone.

    ``others``: by path of a failure mode, units of its kind, as teachers; None: those that the design names. What is
    returned is a ``wear`` of reports. Raises DataError where a table of teachers is none.
    """
    others = teachers_of(robot) if others is None else others
    return tuple(
        seen_of_mode(robot, mode, mode.wear, course, others.get(mode.path, ()))
        for mode in robot.modes
        if mode.wear and (course := ledger.wear.get(mode.key)) is not None
    )


def seen_of_mode(
    robot: Robot, mode: FailureMode, said: WearSignal, course: WearCourse, others: Sequence[Unit] = ()
) -> SeenWear:
    """Return the wear of one failure mode, whose forecast is kept for the same readings."""
    read = course.readings(said)
    taught = ((*(np.asarray(one).tobytes() for one in (unit.times, unit.values)), unit.failed) for unit in others)
    key = (mode.path, mode.key, robot.part_of(mode), said, *(one.tobytes() for one in read[:4]), *taught)
    with _lock:
        if key in _forecasts:
            _forecasts.move_to_end(key)
            return _forecasts[key]
    found = _foretold(robot, mode, said, read, others)
    with _lock:
        _forecasts[key] = found
        if len(_forecasts) > KEPT:
            _forecasts.popitem(last=False)
    return found


def _foretold(
    robot: Robot, mode: FailureMode, said: WearSignal, read: WearReadings, others: Sequence[Unit]
) -> SeenWear:
    count = len(read.values)
    seen = SeenWear(
        mode.path, robot.part_of(mode), words(said), "too few readings", CLOCK_UNITS[mode.clock], count, said.threshold,
        share=said.share,
    )  # fmt: skip
    if not count:
        return replace(seen, why="no sample of it counts")
    seen = replace(seen, last=float(read.values[-1]), when=int(read.when[-1]))
    try:
        worn = worn_of(mode, read, WearOptions(changes=False), others)
    except DataError as error:
        return replace(seen, why=str(error).partition(": ")[2] or str(error))
    found = replace(seen_of(worn, robot.part_of(mode), said.share), signal=words(said))
    return as_read(found, mode, read)


def words(said: WearSignal) -> str:
    """Return what is read, in words."""
    text = f"{said.reading} of {said.gauge.signal}"
    text += f" above {said.ambient.signal}" if said.ambient else ""
    return text + (f" at {said.load.signal} {said.load.low:g} … {said.load.high:g}" if said.load else "")


def worn_of(mode: FailureMode, read: WearReadings, options: WearOptions, others: Sequence[Unit] = ()) -> WornMode:
    """Return the wear of a failure mode by its readings, whose source is its path and the signal.

    ``others``: units of its kind, as teachers. Raises DataError as ``worn_mode``.
    """
    said = mode.wear
    if said is None or not len(read.values):
        signal = said.gauge.signal if said else ""
        raise DataError(f"'{mode.path}': no sample of {signal} counts; expected some, as its `wear` says")
    readings = Readings(read.ages, read.values, None, dated=False, when=read.when)
    source = f"{mode.path}, {words(said)}"
    age, pace = _ageing(mode, read)
    return worn_mode(
        mode, source, readings, said.threshold, deviation=said.threshold_deviation, options=options, others=others,
        stated=StatedLife(mode.life, mode.initial_exposure + age - pace * float(read.ages[-1]), pace),
    )  # fmt: skip


def seen_of(worn: WornMode, part: str, share: float = 1.0) -> SeenWear:
    """Return the same wear as the engine takes it: from the last reading on."""
    wear, readings = worn.wear, worn.readings
    state: WearState = "foretold"
    if wear.worn_out:
        state = "reached"
    elif not wear.followed:
        state = "not followed"
    elif not wear.said:
        state = "no trend"
    life, never = None, wear.never
    if wear.said and state != "reached":
        life, never = ForetoldLife.through(wear.cumulative_hazard, float(np.ptp(readings.times)))
    early, median, late = wear.remaining if life or state == "reached" else (math.inf,) * 3
    return SeenWear(
        worn.mode.path, part, worn.source, state, worn.unit, len(readings.values), wear.signal_threshold,
        float(worn.values[-1]), int(readings.when[-1]) if readings.when is not None else None, early, median, late,
        never, dated=readings.dated, life=life, share=share,
    )  # fmt: skip


def as_read(seen: SeenWear, mode: FailureMode, read: WearReadings) -> SeenWear:
    """Return it with the age of the part when it was read last, and the mean stress factor until then."""
    aged, stress = _ageing(mode, read)
    return replace(seen, aged=aged, stress=stress)


def _ageing(mode: FailureMode, read: WearReadings) -> tuple[float, float]:
    """Age, as the mode's life counts it, at the last reading, and what a unit of the readings' clock adds to it."""
    if mode.scaling != "age":
        return float(read.ages[-1]), 1.0
    gone, aged = (float(one[-1] - one[0]) for one in (read.ages, read.effective))
    return float(read.effective[-1]), aged / gone if gone > 0 and aged > 0 else 1.0


def with_alarms(robot: Robot, ledger: Ledger, seen: Sequence[SeenWear]) -> tuple[SeenWear, ...]:
    """Return it with the changes of its signals against their first readings, which takes seconds the first time."""
    by_path = {mode.path: mode for mode in robot.modes}
    found = []
    for one in seen:
        mode = by_path[one.mode]
        course = ledger.wear.get(mode.key)
        if mode.wear is None or course is None:
            found.append(one)
            continue
        read = course.readings(mode.wear)
        detector, unlooked, _ = changes_in(read.values, WearOptions())
        alarms = None
        if detector is not None:
            alarms = tuple(
                WearAlarm(
                    int(read.when[each.begin]), int(read.when[each.raised]),
                    None if each.end is None else int(read.when[each.end]), each.level, detector.mean,
                )
                for each in episodes(detector, read.values)
            )  # fmt: skip
        found.append(replace(one, alarms=alarms, unlooked=unlooked))
    return tuple(found)
