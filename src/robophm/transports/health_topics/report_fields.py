"""The contents of messages, made of a report, as mappings of the messages' fields."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import count
from typing import Any

from robophm.core.counted_notes import ordinary, said
from robophm.core.signal import SECOND
from robophm.design.robot import UNKNOWN
from robophm.health.alarms import Alarm
from robophm.health.outlooks import View
from robophm.health.prognosis import RemainingLife
from robophm.health.report import VIEWS, ComponentHealth, HealthReport
from robophm.health.subject import FAILED, STALE, State, Subject
from robophm.health.unknown_rates import PartsOfUnknownRate, marked, marks
from robophm.health.worn import WEAR, SeenWear, moment
from robophm.transports.signals.report_sink import JudgedTask

Fields = Mapping[str, Any]

MOST_TOLD = 5
"""Notes that are in the message of a status; up to MOST_STATUSES are among its values."""

LEVELS: dict[State, int] = {"ok": 0, "warn": 1, "error": 2, "stale": 3}
"""Levels of diagnostic_msgs/DiagnosticStatus and phm_msgs/Health for each state."""

MOST_STATUSES = 50
"""The most statuses in one message of /diagnostics (REP-107), beyond which only the outermost modules are told."""

MOST_ALARMS = 5
"""The latest changes of one signal that one status lists, at most."""

COLOURS: dict[State, tuple[float, float, float]] = {
    "ok": (0.0, 0.62, 0.45),
    "warn": (0.90, 0.62, 0.0),
    "error": (0.84, 0.37, 0.0),
    "stale": (0.6, 0.6, 0.6),
}
"""Red, green and blue of a state; told apart by the colour-blind (Okabe and Ito, 2008)."""

_NAN = float("nan")


def stamp(time: int | None) -> Fields:
    """Return the fields of builtin_interfaces/Time, or ``time`` of ROS 1."""
    seconds, nanoseconds = divmod(time or 0, SECOND)
    return {"sec": seconds, "nanosec": nanoseconds}


def hazard_rates(report: HealthReport) -> Fields:
    """Return the fields of phm_msgs/HazardRate of the 2020 tool [1/h]: the robot and its outermost modules."""
    return _of_modules(report, "hazard_rate")


def reliabilities(report: HealthReport) -> Fields:
    """Return the fields of phm_msgs/Reliability of the 2020 tool: survival since new."""
    return _of_modules(report, "reliability")


_SAYS_NOTHING = {"hazard_rate": 0.0, "reliability": 1.0, "unreliability": 0.0, "completion": 1.0, "failure": 0.0,
                 "remaining_life": float("inf")}  # fmt: skip
"""Bounds that say nothing, where parts of unknown rate are left out: a rate of at least 0, a life of at most for
ever."""


def _said(name: str, value: float, left_out: PartsOfUnknownRate | bool | None) -> float:
    """A figure as it is, NaN where parts of unknown rate leave of it a bound that says nothing."""
    return _NAN if left_out and value == _SAYS_NOTHING[name] else value


def _of_modules(report: HealthReport, figure: str) -> Fields:
    def said(one: Subject, view: View) -> float:
        return _said(figure, getattr(getattr(one, view), figure), one.unknown)

    modules = [one for one in report.subjects if one.kind == "module" and "/" not in one.path]
    return {
        "stamp": stamp(report.time),
        "system_value": said(report.system, "nominal"),
        "system_sensor_based_value": said(report.system, "sensor_based"),
        "module_names": [one.path for one in modules],
        "module_values": [said(one, "nominal") for one in modules],
        "module_sensor_based_values": [said(one, "sensor_based") for one in modules],
    }


def task_completions(time: int, actual: JudgedTask | None, predicted: JudgedTask | None) -> Fields:
    """Return the fields of phm_msgs/Potc of the 2020 tool: time in h, distance in m; NaN before there is any."""
    return {"stamp": stamp(time), "actual_potc": _potc(actual), "predict_potc": _potc(predicted)}


def _potc(task: JudgedTask | None) -> Fields:
    if task is None:
        return dict.fromkeys(("potc_nominal_value", "potc_sensor_based_value", "potc_time", "potc_distance"), _NAN)
    return {
        **{
            f"potc_{view}_value": _said("completion", task.completion[view].probability, task.unknown) for view in VIEWS
        },
        "potc_time": task.duration,
        "potc_distance": task.distance,
    }


OUTCOMES = {"succeeded": 1, "failed": 2, "cancelled": 3}
"""Values of phm_msgs/TaskCompletion for the ends of a task; 0 is one that is planned."""


def task_completion(task: JudgedTask) -> Fields:
    """Return the fields of a phm_msgs/TaskCompletion message of one task."""
    return {
        "header": {"stamp": stamp(task.time)},
        "topic": task.topic,
        "goal": task.goal,
        "outcome": OUTCOMES[task.outcome] if task.done else 0,
        "duration": task.duration,
        "distance": task.distance,
        **{
            f"completion_{view}": _said("completion", task.completion[view].probability, task.unknown) for view in VIEWS
        },
        **{f"failure_{view}": _said("failure", task.completion[view].failure, task.unknown) for view in VIEWS},
    }


def health(report: HealthReport, of: Subject | ComponentHealth) -> Fields:
    """Return the fields of phm_msgs/Health; the remaining life of a component is sensor-based alone."""
    if isinstance(of, Subject):
        views = {view: getattr(of, view) for view in VIEWS}
        rates, survival, failed, lives = (
            {view: getattr(figures, name) for view, figures in views.items()}
            for name in ("hazard_rate", "reliability", "unreliability", "remaining_life")
        )
        completions = {view: figures.completion for view, figures in views.items()}
        state = of.state
    else:
        rates = {view: getattr(of, f"{view}_hazard_rate") for view in VIEWS}
        survival = {view: getattr(of, f"{view}_reliability") for view in VIEWS}
        failed = {view: getattr(of, f"{view}_unreliability") for view in VIEWS}
        lives = {"nominal": None, "sensor_based": of.remaining_life}
        completions = dict.fromkeys(VIEWS)
        silent = any(flag.startswith(STALE) for flag in of.flags)
        worn = any(flag.startswith(WEAR) for flag in of.flags)
        lost = any(flag.startswith(FAILED) for flag in of.flags)
        state = "error" if lost else "stale" if silent else "warn" if of.unknown or worn else "ok"
    fields: dict[str, Any] = {
        "header": {"stamp": stamp(report.time)},
        "path": of.path,
        "state": LEVELS[state],
        "stale": any(flag.startswith(STALE) for flag in of.flags),
        "extrapolated": "extrapolated" in of.flags,
    }
    for view in VIEWS:
        done, life = completions[view], lives[view]
        fields |= {
            f"hazard_rate_{view}": _said("hazard_rate", rates[view], of.unknown),
            f"reliability_{view}": _said("reliability", survival[view], of.unknown),
            f"unreliability_{view}": _said("unreliability", failed[view], of.unknown),
            f"completion_{view}": _said("completion", done.probability, of.unknown) if done else _NAN,
            f"failure_{view}": _said("failure", done.failure, of.unknown) if done else _NAN,
            **{
                f"remaining_life_{name}_{view}": _said("remaining_life", value, of.unknown)
                for name, value in _quantiles(life).items()
            },
        }
    return fields


def _quantiles(life: RemainingLife | None) -> Mapping[str, float]:
    names = ("early", "median", "late")
    return {name: getattr(life, name) if life else _NAN for name in names}


def diagnostics(report: HealthReport, node: str) -> Fields:
    """Return the fields of diagnostic_msgs/DiagnosticArray by REP-107: one status for the robot and each module."""
    told = [one for one in report.subjects if one.kind in ("robot", "module")]
    if len(told) > MOST_STATUSES:
        told = [one for one in told if "/" not in one.path][:MOST_STATUSES]
    return {
        "header": {"stamp": stamp(report.time)},
        "status": [
            {
                "level": LEVELS[one.state],
                "name": f"{node}: {one.path}",
                "message": _words(one),
                "hardware_id": report.robot,
                "values": [
                    {"key": key, "value": value if isinstance(value, str) else repr(value)}
                    for key, value in _values(one).items()
                ],
            }
            for one in told
        ]
        + [_worn(report, one, node) for one in report.wear[:MOST_STATUSES]],
    }


def logged(line: str, time: int, node: str, generation: int) -> Fields:
    """Return the fields of a warning in the log: rosgraph_msgs/Log of ROS 1, rcl_interfaces/Log of ROS 2."""
    common = {"name": f"/{node}", "msg": line, "file": "robophm", "function": "watch"}
    if generation == 1:
        return {**common, "header": {"stamp": stamp(time)}, "level": 4, "topics": []}
    return {**common, "name": node.replace("/", "."), "stamp": stamp(time), "level": 30}


def listening(notes: Mapping[str, int], robot: str, node: str, *, fresh: bool) -> Fields:
    """Return the fields of a status on what was lost, silent or refused while listening; ``fresh``: a moment ago.

    Its message has the first of the notes, in their order, and how many more there are.
    """
    told = [line for what, count in notes.items() if not ordinary(what) for line in said({what: count})]
    more = [f"and {len(told) - MOST_TOLD} more"] if len(told) > MOST_TOLD else []
    return {
        "level": LEVELS["warn" if fresh and told else "ok"],
        "name": f"{node}: listening",
        "message": "; ".join(told[:MOST_TOLD] + more) if told else "nothing was lost",
        "hardware_id": robot,
        "values": [{"key": f"note {k}", "value": line} for k, line in enumerate(told[:MOST_STATUSES], 1)],
    }


def alarm(one: Alarm, robot: str, node: str) -> Fields:
    """Return the fields of the status of an alarm: its severity while it goes on, OK once it has ended."""
    values: dict[str, float | int | str] = {"since": moment(one.begin)}
    if one.end is not None:
        values["until"] = moment(one.end)
    if one.acknowledged_by:
        values["acknowledged by"] = one.acknowledged_by
    doubt = f"; whether it goes on is not known, it {one.doubt}" if one.doubt else ""
    return {
        "level": LEVELS[one.severity if one.end is None else "ok"],
        "name": f"{node}: alarm: {one.what}",
        "message": f"{one.cause}{doubt}" if one.end is None else one.ended_by,
        "hardware_id": robot,
        "values": [{"key": key, "value": str(value)} for key, value in values.items()],
    }


def _worn(report: HealthReport, one: SeenWear, node: str) -> Fields:
    """The wear of a failure mode: an error where its threshold is reached, a warning where no model follows it."""
    state: State = "error" if one.state == "reached" else "warn" if one.critical or one.alarming else "ok"
    values: dict[str, float | int | str] = {"signal": one.signal, "state": one.state, "readings": one.readings}
    if one.last is not None:
        values |= {"last reading": one.last, "threshold": one.threshold}
    if one.state not in ("reached", "too few readings"):
        values |= {f"to the threshold, {name} [{one.unit}]": getattr(one, name) for name in ("early", "median", "late")}
    for k, alarm in enumerate((one.alarms or ())[-MOST_ALARMS:], 1):
        span = f"{moment(alarm.begin)} to {moment(alarm.end) if alarm.end is not None else 'now'}"
        values[f"change {k}"] = f"{span}: {alarm.level:.4g}, at first {alarm.usual:.4g}"
    return {
        "level": LEVELS[state],
        "name": f"{node}: wear of {one.mode}",
        "message": one.says + (f"; {one.alarming.words}" if one.alarming else ""),
        "hardware_id": report.robot,
        "values": [{"key": key, "value": str(value)} for key, value in values.items()],
    }


def _words(one: Subject) -> str:
    """All remarks on a subject, with the effect of parts of unknown rate in full."""
    marks = [one.unknown.sentence if one.unknown and mark == one.unknown.words else mark for mark in one.marks]
    return "; ".join((*one.breaches, *one.warnings, *marks)) or "OK"


def _values(one: Subject) -> dict[str, float | str]:
    values: dict[str, float | str] = {}
    for view in VIEWS:
        figures, name = getattr(one, view), view.replace("_", "-")
        values |= {
            f"hazard rate, {name} [1/h]": figures.hazard_rate,
            f"reliability, {name}": figures.reliability,
        }
        if life := figures.remaining_life:
            values[f"remaining life, median, {name} [h]"] = life.median
            values[f"remaining life, 5 %, {name} [h]"] = life.early
        if done := figures.completion:
            values[f"completion of the task, {name}"] = done.probability
    if left_out := one.unknown:
        values |= {
            f"parts of {UNKNOWN} rate": left_out.parts,
            "hazard rates are": left_out.hazard_rate,
            "reliabilities are": left_out.reliability,
            "remaining lives and completions are": left_out.ahead,
        }
    return values


def markers(report: HealthReport, frame: str) -> Fields:
    """Return the fields of visualization_msgs/MarkerArray: boxes above the robot, one for it and each module, with
    names.
    """
    told = [one for one in report.subjects if one.kind in ("robot", "module")]
    numbers = count()
    found = []
    for row, one in enumerate(reversed(told)):
        red, green, blue = COLOURS[one.state]
        rate = marked(marks(one.unknown)[0], f"{one.sensor_based.hazard_rate:.3g}/h")
        depth = 0 if one.kind == "robot" else one.path.count("/") + 1
        common = {"header": {"stamp": stamp(report.time), "frame_id": frame}, "frame_locked": True}
        text = f"{one.path.rpartition('/')[2]}: {one.state.upper()}, λ {rate}"
        left = 0.3 * depth
        beside = left + 0.15 + len(text) * _LETTER * _HEIGHT / 2  # a text is centred where it stands
        for type_, across, scale, words in ((_BOX, left, 0.15, ""), (_TEXT, beside, _HEIGHT, text)):
            found.append(
                {
                    **common,
                    "ns": "robophm",
                    "id": next(numbers),
                    "type": type_,
                    "pose": {
                        "position": {"x": 0.0, "y": -across, "z": 1.0 + 0.25 * row},
                        "orientation": {"w": 1.0},
                    },
                    "scale": dict.fromkeys("xyz", scale),
                    "color": {"r": red, "g": green, "b": blue, "a": 1.0},
                    "text": words,
                }
            )
    return {"markers": found}


_BOX, _TEXT = 1, 9
"""Marker.CUBE and Marker.TEXT_VIEW_FACING."""

_HEIGHT = 0.16
"""Height of a text [m]."""

_LETTER = 0.44
"""Width of a letter in RViz, on average, by its height."""


def told_of(report: HealthReport) -> Sequence[Subject | ComponentHealth]:
    """Return all that has a topic of its own: robot, modules, components; not functions, whose names may be theirs."""
    return [*(one for one in report.subjects if one.kind in ("robot", "module")), *report.components]
