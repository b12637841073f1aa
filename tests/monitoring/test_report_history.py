"""Reports by several processes: bit for bit those of one, and nothing is left behind, however a replay ends."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.transports.recordings.columns.test_splits import split

from robophm.cli import INTERRUPTED, INVALID
from robophm.core.errors import RobophmError
from robophm.core.signal import HOUR, SECOND, Sample
from robophm.design.file import load, parse
from robophm.design.robot import Robot
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.monitoring.report_history import ReportHistory, ReportProcesses
from robophm.stores.figures import STATES
from robophm.stores.memory import MemoryStore
from robophm.transports.synthetic import SyntheticOta

ROOT = Path(__file__).parents[2]
OTA = ROOT / "examples/ota/robot.yaml"
T0 = 1_709_553_600 * SECOND

FORMULA = """
schema_version: 1
name: pump
modules:
  Pump:
    signals: {temperature: {topic: /t, field: temperature, unit: degC, range: [-40, 125]}}
    acceleration: {model: q10, reference_temperature: 25 degC, q: 2}
    components:
      Seal:
        hazard: {formula: "2 * exp(0.05 * (temperature - 25))", unit: FIT, source: its maker,
                 variables: {temperature: {value: 30 degC, unit: degC}}}
      Valve: {rate: 1e-5 /h, quantity: 2}
"""


@pytest.mark.full
@pytest.mark.parametrize("design", [*sorted(ROOT.glob("examples/*/robot.yaml")), FORMULA], ids=str)
def test_a_robot_in_another_process_is_the_same(design: Path | str) -> None:
    robot = load(design) if isinstance(design, Path) else parse(design)
    again: Robot = pickle.loads(pickle.dumps(robot))
    reports = []
    for one in (robot, again):
        monitor = Monitor(one)
        for number in range(3):
            for name in one.signals:
                monitor.observe(Sample(T0 + number * 60 * SECOND, name, 40.0 + number))
        reports.append(monitor.report().to_json())
        assert one.limited_parts.keys() == robot.limited_parts.keys()
    assert reports[0] == reports[1]


@pytest.mark.full
def test_reports_of_several_processes_are_those_of_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of files that follow each other, some that overlap them, one damaged, one missing, and one from before."""
    robot = load(OTA)
    parts = split(SyntheticOta(seed=2, start=T0, duration=240 * SECOND).record(tmp_path / "a.mcap"), tmp_path / "parts")
    damaged = bytearray(parts[5].read_bytes())
    damaged[len(damaged) // 2] ^= 0x55
    parts[5].write_bytes(damaged)
    parts[9].unlink()
    SyntheticOta(seed=3, start=T0 + 100 * SECOND, duration=60 * SECOND).record(tmp_path / "parts/another.mcap")
    asked: list[bool] = []
    report = ReportProcesses.report

    def counted(self: ReportProcesses, *ledger_and_wear: object) -> object:
        asked.append(bool(found := report(self, *ledger_and_wear)))  # type: ignore[arg-type]
        return found

    monkeypatch.setattr(ReportProcesses, "report", counted)
    pasts = []
    for jobs in (1, 2):
        store = MemoryStore()
        health = replay(robot, tmp_path / "parts", store=store, period=5, report_every=5, jobs=jobs)
        pasts.append((store.ledger(robot.name), list(store.history(robot.name).reports()), health.to_json()))
    assert pasts[0] == pasts[1]
    assert len(pasts[0][1]) > 30
    assert sum(asked) >= 2  # the first two wait for a process in any case


MOTOR = """
schema_version: 1
name: motor
components:
  motor:
    rate: 8 FPMH
    acceleration: {model: q10, reference_temperature: 25 degC}
    signals: {temperature: {topic: /motor, field: temperature, unit: degC, max_age: 30 s}}
"""


@pytest.mark.parametrize("period", [1, 60])
def test_no_morning_begins_with_the_last_values_of_the_day_before(tmp_path: Path, period: int) -> None:
    """Three days of ten minutes, each at 65 °C in the end: λ is 8 FPMH · 2⁴ there, and 8 FPMH at first."""
    days = range(3)
    for day in days:
        rows = [(T0 // SECOND + day * 86_400 + t, 25 if t < 300 else 65) for t in range(0, 600, 5)]
        text = "time,/motor.temperature\n" + "".join(f"{at},{value}\n" for at, value in rows)
        (tmp_path / f"{day}.csv").write_text(text)
    store = MemoryStore()
    days_of = sorted(tmp_path.glob("*.csv"))
    replay(parse(MOTOR), days_of, store=store, period=period, report_every=60)
    found = store.history("motor").figures()
    rates, states = found.of("hazard_rate.sensor_based")[1], found.of("state")[1]
    assert set(states) == {STATES.index("ok")}
    into = (found.times - T0) / SECOND % 86_400
    assert set(((found.times - T0) // (86_400 * SECOND)).tolist()) == {0, 1, 2}
    assert into.max() < 600  # none is of a night
    assert rates[into < 300] == pytest.approx(8e-6, rel=1e-6)
    assert rates[into > 300] == pytest.approx(16 * 8e-6, rel=1e-6)
    assert min((into < 300).sum(), (into > 300).sum()) >= 12


@pytest.mark.parametrize("read", ["at once", "one by one", "sample by sample"])
def test_drives_shorter_than_a_minute_are_in_the_history(tmp_path: Path, read: str) -> None:
    """Six of half a minute, an hour apart, each at 65 °C in the end: λ is 8 FPMH · 2⁴ there."""
    drives = range(6)
    for drive in drives:
        rows = [(T0 // SECOND + drive * 3600 + t, 25 if t < 15 else 65) for t in range(7, 37, 3)]
        text = "time,/motor.temperature\n" + "".join(f"{at},{value}\n" for at, value in rows)
        (tmp_path / f"{drive}.csv").write_text(text)
    store = MemoryStore()
    robot = parse(MOTOR)
    paths = sorted(tmp_path.glob("*.csv"))
    if read == "one by one":
        for path in paths:
            replay(robot, [path], store=store)
    elif read == "at once":
        replay(robot, paths, store=store)
    else:
        course = ReportHistory(robot, 600 * SECOND, None, lambda _: ())
        monitor = Monitor(robot, on_tick=course.follow, on_rest=course.rest)
        for path in paths:
            for line in path.read_text().splitlines()[1:]:
                at, value = line.split(",")
                monitor.observe(Sample(int(at) * SECOND, "/motor.temperature", float(value)))
        course.end(monitor)
        store.save("motor", monitor.ledger.to_json(), [], course.reports)
    found = store.history("motor").figures()
    assert [(at - T0) / SECOND for at in found.times] == [drive * 3600 + 34 for drive in drives]
    assert found.of("hazard_rate.sensor_based")[1] == pytest.approx(16 * 8e-6, rel=1e-6)
    assert set(found.of("state")[1]) == {STATES.index("ok")}
    after = 60 if read == "sample by sample" else 0  # s that it is taken to be on, where no recording's end is known
    operated = [27 * (drive + 1) + after * drive for drive in drives]
    assert found.of("operating")[1] * 3600 == pytest.approx(operated, rel=1e-6)


def test_a_robot_that_says_that_it_is_on_and_falls_silent_is_reported_on(tmp_path: Path) -> None:
    """Ten minutes of temperatures, then half an hour of nothing, then one more."""
    times = [*range(0, 600, 5), 2400, 2500, 2600]
    rows = "".join(f"{T0 // SECOND + t},25,{1 if t == 0 else ''}\n" for t in times)
    (tmp_path / "day.csv").write_text(f"time,/motor.temperature,/power.on\n{rows}")
    store = MemoryStore()
    robot = parse(f"{MOTOR}powered: {{topic: /power, field: on}}\n")
    replay(robot, [tmp_path / "day.csv"], store=store, period=60, report_every=60)
    found = store.history("motor").figures()
    assert STATES.index("stale") in found.of("state")[1][(found.times - T0) / SECOND > 700]


@pytest.mark.parametrize("jobs", [0, 1.5, 257, "2"])
def test_jobs_that_are_no_number_of_processes(jobs: object) -> None:
    with pytest.raises(RobophmError, match=r"^jobs "):
        replay(load(OTA), SyntheticOta(duration=SECOND), store=MemoryStore(), jobs=jobs)  # type: ignore[arg-type]


def children(group: int) -> list[int]:
    """The processes of a group that make reports."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and os.getpgid(int(entry.name)) == group:
                found += [int(entry.name)] if b"spawn_main" in (entry / "cmdline").read_bytes() else []
        except OSError:  # it has ended meanwhile
            continue
    return found


def until(true: Callable[[], object]) -> None:
    end = time.monotonic() + 120
    while not true():
        assert time.monotonic() < end
        time.sleep(0.02)


@contextmanager
def replaying(folder: Path) -> Iterator[subprocess.Popen[str]]:
    """A replay that goes on for minutes, with another process; none of its group is left at the end."""
    recording = SyntheticOta(seed=1, start=T0, duration=HOUR).record(folder / "drive.mcap")
    program = (
        "import signal, robophm.monitoring.replay as replaying; from robophm.cli import main\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "replaying.REPORT_STEP = 1\n"
        "replaying.Monitor.__init__.__kwdefaults__['period'] = 0.1\n"
        "replaying.replay_sessions.__kwdefaults__['period'] = 0.1\n"
        "if __name__ == '__main__': main()\n"
    )
    words = [sys.executable, "-c", program, "replay", OTA, recording, "--store", folder / "past.db", "--jobs", "2"]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        try:
            until(lambda: process.poll() is not None or children(process.pid))
            yield process
        finally:
            if process.poll() is None:
                process.kill()
    until(lambda: not children(process.pid))


@pytest.mark.full
def test_an_interrupted_replay_leaves_no_process(tmp_path: Path) -> None:
    """From the keyboard all processes are interrupted at once; one line is said."""
    with replaying(tmp_path) as process:
        os.killpg(process.pid, signal.SIGINT)
        assert process.communicate(timeout=120)[1] == "interrupted\n"
        assert process.returncode == INTERRUPTED


def test_a_process_that_is_killed_ends_the_replay_in_one_line(tmp_path: Path) -> None:
    with replaying(tmp_path) as process:
        os.kill(children(process.pid)[0], signal.SIGKILL)
        said = process.communicate(timeout=120)[1]
        assert process.returncode == INVALID
        assert said.startswith("error: a process that made reports was killed, or had no memory left;")
        assert said.count("\n") == 1


@pytest.mark.full
def test_no_process_outlives_a_replay_that_is_killed(tmp_path: Path) -> None:
    with replaying(tmp_path) as process:
        process.kill()
