"""A part that has failed and waits for its repair: known in every look ahead, and no life is counted meanwhile."""

import json

import pytest

from robophm.core.errors import RobophmError
from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.health.alarms import Alarms
from robophm.health.ledger import Ledger
from robophm.health.part_due import dues
from robophm.health.service import ServiceNote, failures, service_intervals, take_note
from robophm.monitoring.monitor import Monitor
from robophm.stores.events import events_of

WRITTEN = """
schema_version: 1
name: R
task: {duration: 1 h}
powered: {topic: /on, field: data}
modules:
  drive:
    diagram: {parallel: [left, right]}
    components: {left: {rate: 0.04 /h}, right: {rate: 0.05 /h}}
components:
  bearing: {rate: 0.01 /h, life: {distribution: weibull, shape: 2}, initial_exposure: 5 h}
  lamp: {quantity: 2, rate: 1 FPMH}
  arm: {failure_modes: {a: {rate: 1 FPMH}, b: {rate: 2 FPMH}}}
diagram: {series: [drive, lamp, {parallel: [bearing, arm]}]}
"""
ROBOT = parse(WRITTEN)
START = 1_700_000_000 * SECOND
AT = 40
"""Hours of operation after which parts fail."""


def lived(monitor: Monitor, hours: range) -> Monitor:
    for hour in hours:
        monitor.observe(Sample(START + hour * HOUR, CLOCK, 0.0))
        monitor.observe(Sample(START + hour * HOUR, "/on.data", 1.0))
    return monitor


@pytest.fixture
def monitor() -> Monitor:
    return lived(Monitor(ROBOT, period=HOUR / SECOND), range(AT + 1))


def failed(part: str) -> ServiceNote:
    return ServiceNote(part, failed=True, waits=True)


def test_a_failure_is_an_alarm_until_it_is_served(monitor: Monitor) -> None:
    """Also of a mode of a part; told by reports, and one that was open goes on in another process."""
    alarms = Alarms()
    assert alarms.look(monitor.report(remaining_life=False)) == []
    take_note(ROBOT, monitor.ledger, failed("arm/b"))
    (begun,) = alarms.look(monitor.report(remaining_life=False))
    assert (begun.what, begun.path, begun.severity, begun.end) == ("failure of arm", "arm", "error", None)
    assert begun.cause == "arm/b was told to have failed"
    assert alarms.look(monitor.report(remaining_life=False)) == []
    alarms = Alarms([begun])
    take_note(ROBOT, monitor.ledger, ServiceNote("arm", failed=True))
    (ended,) = alarms.look(monitor.report(remaining_life=False))
    assert (ended.what, ended.ended_by) == (begun.what, "arm was replaced or repaired")
    assert ended.end == begun.begin  # nothing was heard meanwhile


def operating(monitor: Monitor) -> float:
    return float(monitor.ledger.clocks.value[0])


def test_what_has_failed_is_known_until_it_is_served(monitor: Monitor) -> None:
    """Of a pair one is left: its failure alone decides; of a single path nothing is left."""
    spared = Monitor(ROBOT, monitor.ledger.copy(), period=HOUR / SECOND)
    take_note(ROBOT, monitor.ledger, failed("drive/left"))
    report = monitor.report()
    drive = report.subject("drive")
    assert drive.sensor_based.hazard_rate == pytest.approx(0.05, rel=1e-12)
    assert drive.nominal.hazard_rate == pytest.approx(0.05, rel=1e-12)
    assert (drive.state, drive.flags[0]) == ("warn", "has failed: drive/left")
    flags = {one.path: one.flags for one in report.components}
    assert (flags["drive/left"], flags["drive/right"]) == (("has failed: drive/left",), ())
    assert [one.part for one in dues(report.outlooks["sensor_based"], monitor.ledger).parts if one.state == "now"] == [
        "drive/left"
    ]
    take_note(ROBOT, monitor.ledger, failed("drive/right"))
    report = monitor.report()
    assert report.system.sensor_based.completion.probability == 0.0
    assert (report.state, report.system.state, report.subject("drive").state) == ("error", "error", "error")
    kept = Monitor(ROBOT, Ledger.of(ROBOT, json.loads(json.dumps(monitor.ledger.to_json()))))
    assert kept.report().to_json() == report.to_json()
    for part in ("drive/left", "drive/right"):
        for one in (monitor, spared):
            take_note(ROBOT, one.ledger, ServiceNote(part))
    assert monitor.report().to_json() == spared.report().to_json()


def test_what_passes_until_the_repair_is_no_life(monitor: Monitor) -> None:
    ledger, hours = monitor.ledger, operating(monitor)
    take_note(ROBOT, ledger, failed("bearing"))
    lived(monitor, range(AT + 1, AT + 31))
    assert operating(monitor) > hours + 25
    (done,) = take_note(ROBOT, monitor.ledger, ServiceNote("bearing", 0.5, failed=True))
    assert (done.kind, done.failed) == ("repaired", True)
    assert done.after[1] == pytest.approx(0.5 * (5 + hours), rel=1e-12)  # Kijima: of its age when it failed
    lived(monitor, range(AT + 31, AT + 36))
    lives = [one for one in service_intervals(ROBOT, monitor.ledger) if one.mode.path == "bearing"]
    assert [one.failed for one in lives] == [True, False]
    assert (lives[0].start, lives[0].hours) == (5, pytest.approx(hours, rel=1e-12))
    assert lives[1].hours == pytest.approx(5, rel=0.01)
    assert [one.kind for one in failures(monitor.ledger)] == ["failed"]


def test_a_part_that_waits_lives_no_more(monitor: Monitor) -> None:
    take_note(ROBOT, monitor.ledger, failed("bearing"))
    lived(monitor, range(AT + 1, AT + 31))
    assert [one.failed for one in service_intervals(ROBOT, monitor.ledger) if one.mode.path == "bearing"] == [True]


def test_a_failure_is_counted_once_whatever_the_service_says(monitor: Monitor) -> None:
    """By the mode that was noted; of the other modes of the part none failed."""
    take_note(ROBOT, monitor.ledger, failed("arm/a"))
    done = take_note(ROBOT, monitor.ledger, ServiceNote("arm", failed=True))
    assert [(one.mode.split(" ")[0], one.kind, one.failed) for one in done] == [
        ("arm/a", "replaced", True), ("arm/b", "replaced", False)
    ]  # fmt: skip
    take_note(ROBOT, monitor.ledger, ServiceNote("drive/left", failed=True))
    take_note(ROBOT, monitor.ledger, ServiceNote("drive/left"))
    assert [one.mode.split(" ")[0] for one in failures(monitor.ledger)] == ["arm/a", "drive/left"]
    assert [(one.kind, one.said) for one in events_of(monitor.ledger.to_json())][:2] == [
        ("failure", "arm/a failed"), ("replacement", "arm/a replaced after it had failed"),
    ]  # fmt: skip


def test_what_cannot_be_noted_changes_nothing(monitor: Monitor) -> None:
    take_note(ROBOT, monitor.ledger, failed("bearing"))
    before = monitor.ledger.to_json()
    for part, words in (
        ("bearing", "'bearing' has failed already; expected that it is replaced or repaired first"),
        ("lamp", "does not tell the 2 equal parts of 'lamp' apart"), ("arm", "expected one of 'arm/a', 'arm/b'"),
        ("drive/lefd", "no part 'drive/lefd'; did you mean 'drive/left'?"),
    ):  # fmt: skip
        with pytest.raises(RobophmError, match=words.replace("?", r"\?")):
            take_note(ROBOT, monitor.ledger, failed(part))
    with pytest.raises(RobophmError, match="what waits to be replaced or repaired is neither yet"):
        ServiceNote("bearing", 0.5, failed=True, waits=True)
    assert monitor.ledger.to_json() == before


def test_a_part_that_has_failed_stays_so_under_another_name_and_when_it_is_put_back(monitor: Monitor) -> None:
    take_note(ROBOT, monitor.ledger, failed("bearing"))
    kept = monitor.ledger.to_json()
    renamed = parse(
        WRITTEN.replace("  bearing: {", "  ring: {identity: bearing, ").replace("[bearing, arm]", "[ring, arm]")
    )
    assert Monitor(renamed, Ledger.of(renamed, kept)).report().system.flags == ("has failed: ring",)
    without = parse(
        "\n".join(line for line in WRITTEN.splitlines() if "  bearing:" not in line).replace("bearing, ", "")
    )
    gone = Ledger.of(without, kept)
    assert Monitor(without, gone).report().system.flags == ()
    assert Monitor(ROBOT, Ledger.of(ROBOT, gone.to_json())).report().system.flags == ("has failed: bearing",)
