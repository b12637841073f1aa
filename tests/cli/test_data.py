"""robophm data: what a newcomer sees, what is written, and what a mistake makes of it."""

import itertools
import json
from decimal import Decimal

import pytest
import yaml
from mcap.reader import make_reader

from robophm.cli import INVALID, OK, USAGE
from robophm.cli.data.statistics import MOST_LEVELS
from robophm.core.signal import SECOND
from robophm.transports.recordings.recording import Recording

POWER = "/ota/power/temperature.temperature"


@pytest.fixture
def bags(recording, tmp_path):
    """Two recordings in a folder, of which the second is of another robot."""
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    folder = tmp_path / "bags"
    folder.mkdir()
    (folder / "day.mcap").write_bytes(recording.read_bytes())
    store = get_typestore(Stores.ROS1_NOETIC)
    with Writer(folder / "other.bag") as writer:
        connection = writer.add_connection("/level", "std_msgs/msg/Float64", typestore=store)
        for i in range(20):
            message = store.types["std_msgs/msg/Float64"](float(i % 10))
            writer.write(connection, 10**18 + i * SECOND, store.serialize_ros1(message, "std_msgs/msg/Float64"))
    return folder


def document(done):
    assert (done.returncode, done.stderr) == (OK, "")
    found = json.loads(done.stdout)
    assert found.pop("schema_version") == 1
    return found


def refused(done):
    assert done.stdout == ""
    assert done.returncode == INVALID, done.stderr
    assert done.stderr.startswith("error: ")
    assert done.stderr.count("\n") == 1
    return done.stderr


def test_a_drive_in_many_files_is_one_entry(inside, tmp_path):
    """With the topics once, in fewer than 60 lines; for machines each file comes."""
    from mcap.writer import Writer

    for number in range(70):
        with (tmp_path / f"drive_{number}.mcap").open("wb") as file:
            writer = Writer(file)
            writer.start(profile="ros2")
            schema = writer.register_schema("std_msgs/msg/Float64", "ros2msg", b"float64 data\n")
            for topic in ("/level", *["/charger"] * (number == 40)):
                channel = writer.register_channel(topic, "cdr", schema)
                for second in range(60):
                    time = 10**18 + (60 * number + second) * SECOND
                    writer.add_message(channel, time, b"\0\1\0\0" + bytes(8), time)
            writer.finish()
    shown = inside("data", ".")
    assert (shown.returncode, shown.stderr) == (OK, "")
    words = " ".join(shown.stdout.split())
    assert words.startswith("70 files, drive_0.mcap … drive_69.mcap: 2001-09-09 01:46:40.000 UTC, 1.17 h")
    for text in ("topic in files messages", "/charger 1 60 1", "/level 70 4,200 1"):
        assert text in words
    assert shown.stdout.count("\n") < 60
    found = document(inside("data", ".", "--json"))["recordings"]
    assert [len(one["topics"]) for one in found].count(2) == 1
    assert sum(topic["messages"] for one in found for topic in one["topics"]) == 4260
    statistics = ("data", "statistics", ".", "--signal", "/level.data")
    done = inside(*statistics)
    assert done.stdout.count("\n") < 20
    assert done.stdout.count("Time at level") == 1
    drive, together, apart = (json.loads(inside(*statistics, *how, "--json").stdout)["signals"] for how in
                              ((), ("--together",), ("--apart",)))  # fmt: skip
    assert [drive[0][figure] == together[0][figure] for figure in ("samples", "held", "mean", "levels")] == [True] * 4
    assert (len(drive), [one["samples"] for one in apart]) == (1, [60] * 70)
    done = inside(*statistics, "--apart")
    assert done.stdout.endswith(
        f"Time at level is that of the first {MOST_LEVELS} of 70; --report draws it, --json has all\n"
        "Listed are the first 20 of 70; --together takes the recordings as one drive, --json has all\n"
    )
    assert done.stdout.count("Time at level: ") == MOST_LEVELS
    assert done.stderr == "warning: drive_0.mcap: receipt time used for /level (60 times, and 69 more like it)\n"
    search = ("data", "find", ".", "--signal", "/level.data", "--above", "-1", "--for", "1 s")
    whole, files = (document(inside(*search, *how, "--json"))["hits"] for how in ((), ("--apart",)))
    assert [(hit["begin"], hit["end"]) for hit in whole] == [(10**18, 10**18 + 4199 * SECOND)]
    assert (len(files), {hit["end"] - hit["begin"] for hit in files}) == (70, {59 * SECOND})
    assert "--apart: not used for" in inside(*search, "--apart", "--together").stderr


def test_a_folder_is_listed(inside, bags):
    shown = inside("data", "bags")
    assert (shown.returncode, shown.stderr) == (OK, "")
    for text in ("bags/day.mcap: 2024-03-0", "/ota/battery", "voltage [V]", "sensor_msgs/Temperature",
                 "bags/other.bag: 2001-09-09 01:46:40.000 UTC, 19 s", "/level"):  # fmt: skip
        assert text in shown.stdout
    assert "header." not in shown.stdout
    found = document(inside("data", "list", "bags", "--json", "--gap", "1 s"))
    level = found["recordings"][1]["topics"][0]
    assert (level["messages"], level["interval"], level["gap_count"]) == (20, SECOND, 19)


def test_of_very_many_topics_the_first_are_shown(inside, bags, monkeypatch):
    listed = document(inside("data", "list", "bags", "--json"))["recordings"]
    names = [topic["name"] for one in listed for topic in one["topics"]]
    monkeypatch.setattr("robophm.cli.data.list.MOST_TOPICS", 1)
    shown = inside("data", "bags").stdout
    assert f"and {len(listed[0]['topics']) - 1} more topics; all are in --json" in shown
    assert {name for name in names if f"{name} " in shown} == {one["topics"][0]["name"] for one in listed}
    assert document(inside("data", "list", "bags", "--json"))["recordings"] == listed


def test_finds_name_the_recording_and_the_time(inside, bags):
    done = inside("data", "find", "bags", "--signal", "/level.data", "--above", "7.5", "--for", "1 s")
    assert "bags/other.bag" in done.stdout
    assert "2001-09-09 01:46:48.000 UTC" in done.stdout
    assert "Found 2 times in 2 recordings" in done.stdout
    assert "1 without /level.data: bags/day.mcap" in done.stdout
    found = document(inside("data", "find", "bags", "--signal", "/level.data", "--above", "7.5", "--json"))
    spans = [(hit["begin"] // SECOND - 10**9, hit["end"] // SECOND - 10**9) for hit in found["hits"]]
    assert spans == [(8, 10), (18, 19)]
    assert found["without"] == ["bags/day.mcap"]
    few = inside("data", "find", "bags", "--signal", "/level.data", "--above", "7.5", "--most", "1")
    assert "Listed are the first 1" in few.stdout


def test_levels_are_taken_in_any_unit(inside, recording):
    def hits(*words):
        return document(inside("data", "find", recording, "--signal", POWER, *words, "--json"))["hits"]

    assert hits("--above", "22 degC") == hits("--above", "295.15 K") != []
    assert hits("--faster", "0.1 K/s") == hits("--faster", "6 K/min") != []
    assert hits("--above", "21 degC", "--below", "22 degC") != []


def test_missing_in_a_recording_without_the_topic_is_all_of_it(inside, bags):
    found = document(inside("data", "find", "bags", "--signal", POWER, "--missing", "--for", "5 s", "--json"))
    (hit,) = found["hits"]
    assert hit["recording"] == "bags/other.bag"
    assert (hit["begin"], hit["end"]) == (10**18, 10**18 + 19 * SECOND)
    assert hit["lowest"] is None


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--above", "70"), "'70' has no unit; expected e.g. '70 degC'"),
        (("--above", "70 V"), "unit 'V' does not measure what 'degC' does"),
        (("--above", "hot"), "'hot' is not a number with a unit"),
        (("--above", "nan degC"), "is not a number with a unit"),
        (("--above", "70 degC", "--below", "60 degC"), "nothing is above 70 and below 60"),
        (("--above", "70 degC", "--for", "-10 s"), "-10 s is negative"),
        (("--above", "70 degC", "--for", "10"), "'10' has no unit"),
        (("--above", "70 degC", "--for", "1e300 s"), "is too long"),
        (("--above", "70 degC", "--gap", "0 s"), "--gap 0 s: expected a time above zero"),
        (("--faster", "2 degC"), "does not measure"),
        ((), "expected one thing to find"),
        (("--stuck",), "expected for how long"),
        (("--stuck", "--missing", "--for", "1 s"), "expected one thing to find"),
    ],
)
def test_what_cannot_be_found_is_one_line(inside, recording, words, says):
    assert says in refused(inside("data", "find", recording, "--signal", POWER, *words))


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("/ota/powr/temperature.temperature", "did you mean '/ota/power/temperature'?"),
        ("/ota/power/temperature.temprature", "did you mean 'temperature'?"),
        ("/ota/power/temperature", "e.g. '/ota/power/temperature.temperature'"),
        ("/ota/odom.pose.covariance", "an array"),
        ("/ota/robot_task_list.data", "it has none that can be read"),
    ],
)
def test_names_that_are_not_there(inside, recording, name, says):
    assert says in refused(inside("data", "statistics", recording, "--signal", name))


def test_the_unit_of_a_bare_number_is_its_own(inside, bags):
    says = refused(inside("data", "find", "bags", "--signal", "/level.data", "--above", "7 V"))
    assert "its unit is not known; expected a bare number, as recorded" in says
    faster = refused(inside("data", "find", "bags", "--signal", "/level.data", "--faster", "7 V/s"))
    assert "as recorded, per s" in faster
    assert "not a finite number" in refused(inside("data", "find", "bags", "--signal", "/level.data", "--above", "inf"))


def test_ratios_are_bare_or_in_percent(inside, recording):
    def hits(*words):
        name = "/ota/battery.percentage"
        return document(inside("data", "find", recording, "--signal", name, *words, "--json"))["count"]

    assert hits("--above", "0.5") == hits("--above", "50 percent") > 0
    assert hits("--faster", "1e-9 /s") == hits("--faster", "6e-8 /min")
    refused(inside("data", "find", recording, "--signal", "/ota/battery.percentage", "--above", "e"))


def test_places_without_recordings(inside, tmp_path):
    (tmp_path / "empty").mkdir()
    (tmp_path / "notes.txt").write_text("x")
    assert "empty: holds no recording" in refused(inside("data", "empty"))
    assert "notes.txt: not a recording" in refused(inside("data", "notes.txt"))
    assert "emty: no such file" in refused(inside("data", "emty"))
    (tmp_path / "broken.mcap").write_bytes(bytes(100))
    assert "brokn.mcap: no such file; did you mean 'broken.mcap'?" in refused(inside("data", "brokn.mcap"))
    assert "broken.mcap: cannot be read" in refused(inside("data", "broken.mcap"))
    slip = inside("data", "fnd", "empty")
    assert slip.returncode == USAGE
    assert "No such command 'fnd'" in slip.stderr


def test_statistics_are_printed_and_written(inside, recording, tmp_path):
    done = inside("data", "statistics", recording, "--signal", POWER, "--signal", "/ota/battery.voltage",
                  "--every", "2 min", "--to", "table.csv", "--report", "page.html")  # fmt: skip
    assert (done.returncode, done.stderr) == (OK, "")
    assert "Time at level: /ota/battery.voltage" in done.stdout
    assert "Every 2 min" in done.stdout
    lines = (tmp_path / "table.csv").read_text().splitlines()
    assert lines[0] == "recording,signal,unit,begin,samples,known,lowest,mean,highest,deviation"
    with Recording(recording) as source:
        values = list(source.samples([POWER]))
    rows = [line.split(",") for line in lines[1:] if POWER in line]
    first = [one.value for one in values if one.time < (float(rows[0][3]) + 120) * SECOND]
    assert (int(rows[0][4]), float(rows[0][6]), float(rows[0][8])) == (len(first), min(first), max(first))
    assert sum(int(row[4]) for row in rows) == len(values)
    page = (tmp_path / "page.html").read_text()
    assert page.count("<svg") == 4
    assert "/ota/battery.voltage" in page
    found = document(inside("data", "statistics", recording, "--signal", POWER, "--json"))
    assert found["signals"][0]["samples"] == len(values)
    assert found["windows"] == []


def test_a_file_is_replaced_only_when_asked_to(inside, recording, tmp_path, design):
    commands = [
        (("statistics", recording, "--signal", POWER), "x.csv"),
        (("export", recording, "--signal", POWER), "x.csv"),
        (("profile", design, recording), "x.yaml"),
    ]
    for words, name in commands:
        (tmp_path / name).write_text("mine")
        assert f"{name}: exists; expected a new name, or --force" in refused(inside("data", *words, "--to", name))
        assert (tmp_path / name).read_text() == "mine"
        done = inside("data", *words, "--to", name, "--force")
        assert done.returncode == OK, done.stderr
        assert (tmp_path / name).read_text() != "mine"
    assert "no such folder" in refused(inside("data", *commands[0][0], "--to", "nowhere/x.csv"))
    assert "ends in .csv or .parquet" in refused(inside("data", *commands[1][0], "--to", "x.xlsx"))
    says = refused(inside("data", "profile", design, recording, "--to", design, "--force"))
    assert "is read or kept by this command too" in says


def test_an_exported_table_replays_as_the_recording(inside, recording, design, tmp_path):
    signals = [word for module in ("power", "sensing", "communication", "mobility", "computation")
               for word in ("--signal", f"/ota/{module}/temperature.temperature")]  # fmt: skip
    signals += ["--signal", "/ota/odom.pose.pose.position.x", "--signal", "/ota/odom.pose.pose.position.y"]
    assert inside("data", "export", recording, *signals, "--to", "drive.csv").returncode == OK
    one, other = (json.loads(inside("replay", design, each, "--json").stdout) for each in (recording, "drive.csv"))
    with recording.open("rb") as file:
        end = make_reader(file).get_summary().statistics.message_end_time
    last = Decimal((tmp_path / "drive.csv").read_text().split()[-1].split(",")[0])
    more = float(Decimal(end) / SECOND - last)  # a table ends with its last sample, its recording with any message
    assert 0 < more < 1
    assert (one["clocks"]["operating"] - other["clocks"]["operating"]) * 3600 == pytest.approx(more, abs=1e-9)
    for longer, shorter in zip(one["subjects"], other["subjects"], strict=True):
        for view, figure in itertools.product(("nominal", "sensor_based"), ("hazard_rate", "unreliability")):
            # of two redundant units they grow as the square of time
            assert longer[view][figure] == pytest.approx(shorter[view][figure], rel=3 * more / 600)


def test_a_profile_goes_into_a_prediction_and_into_a_design(inside, recording, design, tmp_path):
    done = inside("data", "profile", design, recording, "--to", "load.yaml", "--report", "page.html")
    assert (done.returncode, done.stderr) == (OK, "")
    assert "mean stress factor" in done.stdout
    ahead = inside("predict", design, "--plan", "load.yaml", "--json")
    assert ahead.returncode == OK, ahead.stderr
    said = yaml.safe_load(design.read_text())
    (said["task"],) = yaml.safe_load((tmp_path / "load.yaml").read_text())["tasks"]
    (tmp_path / "with.yaml").write_text(yaml.safe_dump(said, sort_keys=False))
    asked = [json.loads(inside("task", *words, "--json").stdout)["tasks"][0]["sensor_based"]
             for words in ((design, "load.yaml"), ("with.yaml",))]  # fmt: skip
    assert asked[0] == asked[1]
    found = document(inside("data", "profile", design, recording, "--json"))
    assert len(found["profiles"]) == 5
    assert (tmp_path / "page.html").read_text().count("<svg") == 5


def test_a_profile_of_what_is_not_recorded(inside, bags, design):
    assert "no topic '/ota/" in refused(inside("data", "profile", design, bags / "other.bag"))


def test_plain_text_where_colour_and_unicode_are_not_wanted(run, recording):
    done = run("data", "statistics", recording, "--signal", POWER, PYTHONIOENCODING="ascii")
    assert done.returncode == OK
    assert "\x1b" not in done.stdout
