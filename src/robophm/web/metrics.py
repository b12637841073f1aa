"""The latest figures in the text format of Prometheus."""

from __future__ import annotations

import math
from collections.abc import Iterator

from robophm.core.counted_notes import ordinary
from robophm.web.monitoring import Run
from robophm.web.service import Service

_FIGURES = {
    "hazard_rate": ("robophm_hazard_rate_per_hour", "Hazard rate now, per hour of operation"),
    "reliability": ("robophm_reliability_ratio", "Probability of having survived since new"),
    "unreliability": ("robophm_unreliability_ratio", "Its complement, with its own digits"),
}


def metrics_text(service: Service) -> str:
    """Return all metrics as text; of a robot that is not watched, only that it is not."""
    return "\n".join(_lines(service)) + "\n"


def _lines(service: Service) -> Iterator[str]:
    run = service.monitoring.run
    yield "# HELP robophm_monitoring Whether the robot is watched now"
    yield "# TYPE robophm_monitoring gauge"
    yield f"robophm_monitoring {int(service.monitoring.state == 'running')}"
    report, lives = (run.report, run.lives) if run else (None, None)
    if run is None or report is None:
        return
    yield from _of_run(run)
    robot = _label(report.robot)
    for key, (name, words) in _FIGURES.items():
        yield f"# HELP {name} {words}"
        yield f"# TYPE {name} gauge"
        for subject in report.subjects:
            path = "" if subject.kind == "robot" else subject.path
            for view in ("nominal", "sensor_based"):
                value = getattr(getattr(subject, view), key)
                yield f'{name}{{robot="{robot}",path="{_label(path)}",view="{view}"}} {_number(value)}'
    system = (lives or report).system
    if system.nominal.remaining_life:
        yield "# HELP robophm_remaining_life_hours Quantiles of remaining life, calendar time"
        yield "# TYPE robophm_remaining_life_hours gauge"
        for view in ("nominal", "sensor_based"):
            life = getattr(system, view).remaining_life
            for quantile, value in (("0.05", life.early), ("0.5", life.median), ("0.95", life.late)):
                labels = f'robot="{robot}",view="{view}",quantile="{quantile}"'
                yield f"robophm_remaining_life_hours{{{labels}}} {_number(value)}"
    if report.system.nominal.completion:
        yield "# HELP robophm_task_completion_ratio Probability that the design's task will be completed"
        yield "# TYPE robophm_task_completion_ratio gauge"
        for view in ("nominal", "sensor_based"):
            value = getattr(report.system, view).completion.probability
            yield f'robophm_task_completion_ratio{{robot="{robot}",view="{view}"}} {_number(value)}'
    with service.monitoring.alarm_log(run.robot) as log:
        alarms = log.alarms(open_only=True)
    yield "# HELP robophm_alarm An alarm that goes on"
    yield "# TYPE robophm_alarm gauge"
    for one in alarms:
        labels = ",".join(f'{name}="{_label(one[name])}"' for name in ("what", "path", "severity"))
        yield f'robophm_alarm{{robot="{robot}",{labels}}} 1'
    yield "# HELP robophm_parts_of_unknown_rate Parts that the figures leave out"
    yield "# TYPE robophm_parts_of_unknown_rate gauge"
    left_out = report.system.unknown
    yield f'robophm_parts_of_unknown_rate{{robot="{robot}"}} {left_out.parts if left_out else 0}'
    if report.wear:
        yield "# HELP robophm_wear_remaining Median of what a part's wear has to its threshold, on the part's own clock"
        yield "# TYPE robophm_wear_remaining gauge"
        for worn in report.wear:
            labels = f'robot="{robot}",mode="{_label(worn.mode)}",unit="{worn.unit}",state="{worn.state}"'
            left = 0.0 if worn.state == "reached" else worn.median
            yield f"robophm_wear_remaining{{{labels}}} {_number(left)}"
    yield "# HELP robophm_clock_total How far each clock has gone: hours, kilometres, cycles, starts"
    yield "# TYPE robophm_clock_total counter"
    for clock, value in report.clocks.items():
        yield f'robophm_clock_total{{robot="{robot}",clock="{_label(clock)}"}} {_number(value)}'
    yield "# HELP robophm_threshold_breached Whether a threshold of the design is breached"
    yield "# TYPE robophm_threshold_breached gauge"
    yield f'robophm_threshold_breached{{robot="{robot}"}} {int(bool(report.breaches))}'


def _of_run(run: Run) -> Iterator[str]:
    yield "# HELP robophm_samples_total Samples heard since monitoring began"
    yield "# TYPE robophm_samples_total counter"
    yield f"robophm_samples_total {run.samples}"
    yield "# HELP robophm_past_kept Whether the robot's past was kept when it was last to be"
    yield "# TYPE robophm_past_kept gauge"
    yield f"robophm_past_kept {int(run.kept)}"
    yield "# HELP robophm_incidents_total What was lost, silent, refused or could not be kept, since monitoring began"
    yield "# TYPE robophm_incidents_total counter"
    yield f"robophm_incidents_total {sum(count for what, count in run.notes.items() if not ordinary(what))}"


def _label(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", " ")


def _number(value: float) -> str:
    if math.isnan(value):
        return "NaN"
    return repr(value) if math.isfinite(value) else "+Inf" if value > 0 else "-Inf"
