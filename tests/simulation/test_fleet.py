"""A fleet's folder: complete, in order, readable, the same for the same seed, and in itself consistent."""

import ast
import csv
import itertools
import json
import subprocess
import sys
from collections import defaultdict
from functools import partial
from pathlib import Path

import pytest
from ruamel.yaml import YAML

import robophm.simulation
from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.design.file import load
from robophm.design.task_file import load_plan
from robophm.simulation.fleet import simulate
from robophm.transports.recordings.formats.csv import CsvRecording, parse_time

DESIGN = Path(__file__).resolve().parents[2] / "examples" / "fleet" / "robot.yaml"
ROBOTS, TASKS = 60, 25


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A fleet and what was said about it."""
    folder = tmp_path_factory.mktemp("fleet") / "fleet"
    done = []
    return folder, simulate(DESIGN, folder, ROBOTS, TASKS, 7, done.append), done


def rows(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def tasks_of(folder):
    """Robot → its tasks, each a list of rows, one for each leg."""
    found = defaultdict(list)
    for robot, robots_rows in itertools.groupby(rows(folder / "tasks.csv"), lambda row: row["robot"]):
        found[robot] = [list(legs) for _, legs in itertools.groupby(robots_rows, lambda row: row["task"])]
    return found


def events_of(folder):
    found = defaultdict(list)
    for row in rows(folder / "failures.csv"):
        found[row["robot"]].append((parse_time(row["time"]), row["part"], row["event"]))
    return found


def content(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_everything_is_there(made):
    folder, fleet, done = made
    names = [f"robot-{i:02}" for i in range(1, ROBOTS + 1)]
    assert sorted(path.name for path in folder.iterdir()) == [
        "failures.csv", "plans", "recordings", "robot.yaml", "tasks.csv"]  # fmt: skip
    assert [path.stem for path in sorted((folder / "plans").iterdir())] == names
    assert [path.stem for path in sorted((folder / "recordings").iterdir())] == names
    assert (folder / "robot.yaml").read_bytes() == DESIGN.read_bytes()
    tasks = tasks_of(folder)
    assert list(tasks) == names
    assert {len(of_one) for of_one in tasks.values()} == {TASKS, TASKS + 1, TASKS + 2}  # whole rounds of 1, 2 or 3
    assert list(events_of(folder)) == names
    failed = sum(legs[0]["outcome"] == "failed" for of_one in tasks.values() for legs in of_one)
    assert (fleet.robots, fleet.tasks, fleet.failed) == (ROBOTS, sum(map(len, tasks.values())), failed)
    assert done == list(range(1, ROBOTS + 1))


def test_events_are_in_order_and_end_with_the_next_failure(made):
    folder, fleet, _ = made
    parts_failed = 0
    for events in events_of(folder).values():
        assert [time for time, _, _ in events] == sorted(time for time, _, _ in events)
        ends = [i for i, (_, part, event) in enumerate(events) if (part, event) == ("", "end")]
        assert len(ends) == 1
        assert [event[1:] for event in events[ends[0] + 1 :]] == [("", "failed")]  # the only one after the record
        assert events[-1][0] > events[ends[0]][0]
        parts_failed += sum(event == "failed" and part != "" for _, part, event in events)
    assert parts_failed == fleet.parts_failed


def functions(down):
    """Which functions of examples/fleet/robot.yaml work, worked out by hand."""

    def up(name):
        return name not in down

    power = (up("Power/Battery Left") or up("Power/Battery Right")) and up("Power/Converter")
    mobility = up("Mobility/Bearing") and up("Mobility/Gearbox")
    mobility = mobility and (up("Mobility/Motor Front") or up("Mobility/Motor Rear"))
    arm = all(up(f"Arm/{part}") for part in ("Joint", "Gripper", "Seal"))
    sensing = sum(up(f"Sensing/Camera {i}") for i in (1, 2, 3)) >= 2 and up("Sensing/Lidar")
    whole = power and mobility and arm and sensing and up("Computer")
    return {"drive": power and mobility and up("Computer"), "lift": power and arm, "see": sensing and up("Computer"),
            "": whole}  # fmt: skip


def seconds(leg):
    if leg["duration"]:
        return float(leg["duration"].removesuffix(" min")) * 60
    return float(leg["distance"].removesuffix(" m")) / float(leg["speed"].removesuffix(" m/s"))


def down_at(events, moment):
    """Parts that have failed by then and are not replaced by then."""
    down = set()
    for time, part, event in events:
        if time <= moment and part and event != "inspected":
            (down.add if event == "failed" else down.discard)(part)
    return down


def down_before_repair_at(events, moment):
    """The same, and what is replaced at that very moment."""
    return down_at(events, moment) | {part for time, part, event in events if time == moment and event == "replaced"}


def test_outcomes_follow_from_failures(made):
    """Brute force, from the files alone: what has failed when, so which task failed when, and what was repaired."""
    folder, _, _ = made
    all_events = events_of(folder)
    repairs = refused = part_of_the_robot = 0
    for robot, tasks in tasks_of(folder).items():
        events = all_events[robot]
        down, down_before_repair = partial(down_at, events), partial(down_before_repair_at, events)
        expected_repairs = set()
        for legs in tasks:
            start, end = parse_time(legs[0]["start"]), parse_time(legs[0]["end"])
            needed = [leg["functions"].split(";") for leg in legs]
            part_of_the_robot += [""] not in needed
            if any(not functions(down_before_repair(start))[name] for names in needed for name in names):
                # Either it is repaired now, or the task before it failed at this very moment.
                expected_repairs.add(start)
                refused += 1
            assert all(functions(down(start))[name] for names in needed for name in names)
            begin, failed = start, None
            for leg, names in zip(legs, needed, strict=True):
                until = begin + round(seconds(leg) * SECOND)
                for time in sorted({begin, *(t for t, _, e in events if begin < t <= until and e == "failed"), until}):
                    works = functions((down if time == start else down_before_repair)(time))
                    if failed is None and not all(works[name] for name in names):
                        failed = time
                begin = until
            assert legs[0]["outcome"] == ("completed" if failed is None else "failed")
            assert end == (begin if failed is None else failed)
            if failed is not None:
                expected_repairs.add(failed)
        end = next(time for time, part, event in events if event == "end")
        if not functions(down_before_repair(end))[""]:
            expected_repairs.add(end)
        by_time = defaultdict(set)
        for time, part, event in events:
            if event in ("replaced", "inspected"):
                by_time[time].add((part, event))
        used = by_time.pop(parse_time(tasks[0][0]["start"]))  # as the record begins
        assert used == {("Mobility/Bearing", "inspected"), ("Arm/Joint", "inspected")}
        assert by_time.keys() == expected_repairs
        for time, said in by_time.items():
            failed_parts = down_before_repair(time)
            assert {part for part, event in said if event == "replaced"} == failed_parts
            assert len(said) == 15  # every part of the robot
        repairs += len(by_time)
        # The robot as a whole: it fails once between repairs, at the moment its diagram does.
        system = [time for time, part, event in events if (part, event) == ("", "failed") and time <= end]
        since = 0
        for repair in [*sorted(by_time), end + 1]:
            moments = sorted(t for t, part, e in events if since < t <= min(repair, end) and part and e == "failed")
            fell = [t for t in moments if not functions(down_before_repair(t))[""]]
            assert [t for t in system if since < t <= min(repair, end)] == fell[:1]
            since = repair
    assert repairs > 60
    assert refused > 0
    assert part_of_the_robot > 500


def test_plans_say_what_is_done(made):
    folder, _, _ = made
    keys = ["distance", "speed", "duration"]
    for robot, tasks in tasks_of(folder).items():
        plan = YAML(typ="safe").load(folder / "plans" / f"{robot}.yaml")
        assert plan["schema_version"] == 1
        every = float(plan["every"].removesuffix(" min")) * 60 * SECOND
        starts = [parse_time(legs[0]["start"]) for legs in tasks]
        for number, legs in enumerate(tasks):
            of_list = plan["tasks"][number % len(plan["tasks"])]["legs"]
            for row, leg in zip(legs, of_list, strict=True):
                assert [row[key] for key in keys] == [leg.get(key, "") for key in keys]
                assert row["functions"] == ";".join(leg.get("functions", []))
                assert {key: row[key] for key in ("temperature", "Mobility/load")} == leg["stresses"]
            rounds, place = divmod(number, len(plan["tasks"]))
            before = sum(seconds(leg) for task in tasks[:place] for leg in task)
            assert starts[number] - starts[0] == rounds * every + round(before * SECOND)
        end = next(time for time, _, event in events_of_one(folder, robot) if event == "end")
        assert (end - starts[0]) % every == 0
        assert len(tasks) % len(plan["tasks"]) == 0
        assert end - starts[0] == len(tasks) / len(plan["tasks"]) * every


def test_the_engine_reads_the_plans(made):
    folder, _, _ = made
    robot = load(folder / "robot.yaml")
    assert robot.warnings == ()
    (of_load,) = {
        stress.drivers["load"] for mode in robot.modes for stress in mode.stresses if "load" in stress.drivers
    }
    for path in sorted((folder / "plans").iterdir())[:20]:
        said = YAML(typ="safe").load(path)
        plan = load_plan(path, robot)
        assert plan.every == float(said["every"].removesuffix(" min")) / 60
        for task, legs in zip(plan.tasks, tasks_of(folder)[path.stem], strict=False):
            assert [leg.duration * 3600 for leg in task.legs] == pytest.approx([seconds(leg) for leg in legs])
            assert [";".join(leg.functions) for leg in task.legs] == [leg["functions"] for leg in legs]
            gearbox, joint = (
                [leg.stated(part, part, of_load) for leg in task.legs] for part in ("Mobility/Gearbox", "Arm/Joint")
            )
            assert gearbox == [float(leg["Mobility/load"]) for leg in legs]
            assert joint == [None] * len(legs)


def events_of_one(folder, robot, known={}):  # noqa: B006  read once
    if folder not in known:
        known[folder] = events_of(folder)
    return known[folder][robot]


def test_recordings_say_what_was(made):
    """On in its tasks and only then, near the plan's stresses, at the plan's speed, never silent while on."""
    folder, _, _ = made
    for robot, tasks in itertools.islice(tasks_of(folder).items(), 20):
        recording = CsvRecording(folder / "recordings" / f"{robot}.csv")
        assert recording.signals == {"/power.on", "/wheels.speed", "/wheels.load", "/ambient.temperature"}
        by_time = defaultdict(dict)
        for sample in recording.samples(recording.signals):
            by_time[sample.time][sample.signal] = sample.value
        times = list(by_time)
        assert times == sorted(times)
        events = events_of_one(folder, robot)
        assert times[0] == parse_time(tasks[0][0]["start"])
        assert times[-1] == next(time for time, _, event in events if event == "end")
        expected = {}
        for legs in tasks:
            begin, end = (parse_time(legs[0][key]) for key in ("start", "end"))
            for leg in legs:
                if begin < end:
                    expected[begin] = leg
                begin += round(seconds(leg) * SECOND)
            expected.setdefault(end, None)
            if expected[end] is not None and legs[0]["outcome"] == "failed":
                expected[end] = None
        for time, leg in expected.items():
            said = by_time[time]
            following = next((legs for legs in tasks if parse_time(legs[0]["start"]) == time), None)
            if leg is None and following is None:
                assert said == {"/power.on": 0.0, "/wheels.speed": 0.0}
            elif leg is not None:
                assert said["/power.on"] == 1.0
                assert said["/wheels.speed"] == float((leg["speed"] or "0 m/s").split()[0])
                assert abs(said["/ambient.temperature"] - float(leg["temperature"].split()[0])) <= 1.0
                assert abs(said["/wheels.load"] - float(leg["Mobility/load"])) <= 0.0201
        on = [time for time in times if by_time[time]["/power.on"] == 1.0]
        assert max((b - a for a, b in itertools.pairwise(times) if a in set(on)), default=0) <= 0.8 * 7200 * SECOND


def test_sensors_speak_before_they_are_stale(tmp_path):
    text = DESIGN.read_text().replace("range: [-20, 80], max_age: 2 h", "range: [-4, 176], max_age: 20 s")
    design = tmp_path / "robot.yaml"
    design.write_text(text.replace("unit: degC", "unit: degF"))
    simulate(design, tmp_path / "fleet", 1, 2, 1)
    recording = CsvRecording(tmp_path / "fleet" / "recordings" / "robot-1.csv")
    samples = list(recording.samples(["/power.on", "/ambient.temperature"]))
    on = [(sample.time, sample.value == 1.0) for sample in samples if sample.signal == "/power.on"]
    assert len(on) > 50
    assert all(after - before <= 16 * SECOND for (before, was_on), (after, _) in itertools.pairwise(on) if was_on)
    temperatures = [sample.value for sample in samples if sample.signal == "/ambient.temperature"]
    assert 57 <= min(temperatures) <= max(temperatures) <= 115  # 14 … 46 °C


def test_the_same_seed_writes_the_same_bytes(tmp_path):
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        simulate(DESIGN, tmp_path / name, 5, 3, seed)
    assert content(tmp_path / "a") == content(tmp_path / "b")
    assert content(tmp_path / "a") != content(tmp_path / "c")
    simulate(DESIGN, tmp_path / "d", 5, 3, 3, uncertain_rates=True)
    assert content(tmp_path / "a") != content(tmp_path / "d")


def test_a_folder_that_holds_something_is_left_alone(tmp_path):
    folder = tmp_path / "fleet"
    folder.mkdir()
    simulate(DESIGN, folder, 1, 1, 1)  # an empty one is taken
    before = content(folder)
    with pytest.raises(RobophmError, match="exists and is not empty"):
        simulate(DESIGN, folder, 1, 1, 2)
    assert content(folder) == before
    file = tmp_path / "file"
    file.write_text("x")
    with pytest.raises(RobophmError, match="exists and is not empty"):
        simulate(DESIGN, file, 1, 1, 2)


def test_nothing_is_left_of_what_was_interrupted(tmp_path):
    def interrupt(done):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate(DESIGN, tmp_path / "fleet", 5, 1, 1, interrupt)
    for bad in ({"robots": 0}, {"tasks": 0}, {"seed": -1}, {"design": tmp_path / "none.yaml"}):
        arguments = {"design": DESIGN, "output": tmp_path / "fleet", "robots": 1, "tasks": 1, "seed": 1, **bad}
        with pytest.raises(RobophmError):
            simulate(**arguments)
    assert list(tmp_path.iterdir()) == []


def test_it_shares_nothing_with_the_engine():
    allowed = ("robophm.core.", "robophm.simulation.")
    for path in Path(robophm.simulation.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            assert all(name.startswith(allowed) for name in names if name.startswith("robophm")), (path, names)
            assert not (isinstance(node, ast.ImportFrom) and node.level)
    code = (
        "import sys; from pathlib import Path; from robophm.simulation.fleet import simulate;"
        "import tempfile; simulate(Path(sys.argv[1]), Path(tempfile.mkdtemp()), 1, 1, 1);"
        "print(*(name for name in sys.modules if name.startswith('robophm.')))"
    )
    done = subprocess.run([sys.executable, "-c", code, str(DESIGN)], capture_output=True, text=True, check=True)
    assert {name.split(".")[1] for name in done.stdout.split()} == {"core", "simulation"}


@pytest.mark.full
def test_from_the_command_line(tmp_path):
    def run(*words):
        command = [sys.executable, "-m", "robophm", "simulate", str(DESIGN), "--to", *words]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    done = run("fleet", "--robots", "4", "--tasks", "3", "--seed", "5", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    said = json.loads(done.stdout)
    assert (said["robots"], said["seed"], said["output"]) == (4, 5, "fleet")
    assert 12 <= said["tasks"] <= 4 * 4
    again = run("fleet", "--seed", "5")
    assert (again.returncode, again.stderr) == (
        3,
        "error: fleet: exists and is not empty; expected a folder of its own\n",
    )
    fresh = run("other", "--robots", "2", "--tasks", "2")
    assert fresh.stdout.startswith("Fleet in other (seed ")
    seed = fresh.stdout.partition("seed ")[2].partition(")")[0]
    simulate(DESIGN, tmp_path / "third", 2, 2, int(seed))
    assert content(tmp_path / "other") == content(tmp_path / "third")
