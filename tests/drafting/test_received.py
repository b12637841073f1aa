"""Files that are handed in: told by content, kept in one folder within bounds; what is refused leaves nothing."""

import pytest
from pymavlink.dialects.v20 import all as dialect

from robophm.core.errors import RobophmError
from robophm.drafting import received
from robophm.drafting.received import ReceivedFiles, endings, file_name

from ..transports.recordings import test_dataflash as dataflash
from ..transports.recordings import test_ulog as ulog
from ..transports.written.mavlink import logged, sender
from .robots import joints, record

URDF = """<robot name="cart"><link name="base"/><link name="wheel_left_link"/>
<joint name="wheel_left_joint" type="continuous"><parent link="base"/><child link="wheel_left_link"/></joint></robot>"""
PARTS = "Reference,Value,Footprint,Qty\nR1,10k,R_0603_1608Metric,1\n"
TABLE = "time,/battery.voltage\n1709553600.0,25.9\n1709553601.0,25.8\n"


@pytest.fixture
def files(tmp_path):
    return ReceivedFiles(tmp_path / "cart.yaml.files")


def hand_in(files, name, content):
    arrival = files.begin(name)
    try:
        for begin in range(0, len(content), 1000):
            arrival.write(content[begin : begin + 1000])
        arrival.keep()
    finally:
        arrival.close()


def test_a_file_is_told_by_its_content(files, tmp_path):
    drive = record(tmp_path / "drive", iter([joints(t, ["wheel"], [0.0], [0.0]) for t in range(3)]))
    hand_in(files, "cart.xml", URDF.encode())
    hand_in(files, "drive.data", drive.read_bytes())
    hand_in(files, "board.csv", PARTS.encode())
    hand_in(files, "battery.csv", TABLE.encode())
    assert {one.name: one.kind for one in files.all()} == {
        "cart.xml": "description", "drive.data": "recording", "board.csv": "parts list", "battery.csv": "recording",
    }  # fmt: skip


def test_logs_of_autopilots_are_recordings_and_their_endings_are_said(files):
    attitude = dialect.MAVLink_attitude_message(1, 0.5, 0, 0, 0, 0, 0)
    station = logged(1_750_000_000_000_000, attitude, sender()) + logged(1_750_000_001_000_000, attitude, sender())
    logs = {"flight.bin": dataflash.flight(), "flight.tlog": station, "flight.ulg": ulog.flight()}
    for name, content in logs.items():
        hand_in(files, name, content)
    assert {one.name: one.kind for one in files.all()} == dict.fromkeys(logs, "recording")
    assert {name.removeprefix("flight") for name in logs} <= set(endings()["recording"])


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("cart.urdf", "<robot><link name=</robot>", "cart.urdf:1: is no XML"),
        ("cart.urdf", "", "cart.urdf:1: is no XML"),
        ("board.csv", "hello\n1\n", "board.csv: has no header"),
        ("board.xlsx", "PK\x03\x04", "board.xlsx: is no workbook"),
        ("drive.mcap", "no recording", "drive.mcap: "),
        ("wheel.stl", "solid", "wheel.stl: tells nothing of a robot; expected its URDF, a recording (.bag, "),
    ],
)
def test_what_is_refused_is_named_and_leaves_nothing_behind(files, tmp_path, name, content, words):
    with pytest.raises(RobophmError) as caught:
        hand_in(files, name, content.encode("latin-1"))
    assert str(caught.value).startswith(words)
    assert "\n" not in str(caught.value)
    assert str(tmp_path) not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_a_bad_file_does_not_take_the_place_of_a_good_one(files):
    hand_in(files, "cart.urdf", URDF.encode())
    with pytest.raises(RobophmError):
        hand_in(files, "cart.urdf", b"<robot")
    assert (files.folder / "cart.urdf").read_text() == URDF
    assert files.evidence().description.name == "cart"


def test_of_two_descriptions_the_later_one_stays_and_the_evidence_is_of_it(files):
    hand_in(files, "cart.urdf", URDF.encode())
    assert files.evidence().description.name == "cart"
    hand_in(files, "other.urdf", URDF.replace("cart", "other").encode())
    assert [one.name for one in files.all()] == ["other.urdf"]
    assert files.evidence().description.name == "other"
    hand_in(files, "other.urdf", URDF.replace("cart", "third").encode())
    assert files.evidence().description.name == "third"
    files.remove("other.urdf")
    assert files.evidence().description is None
    with pytest.raises(RobophmError, match=r"no file .other\.urdf."):
        files.remove("other.urdf")


@pytest.mark.parametrize("name", ["../../cart.urdf", "..\\..\\cart.urdf", "/etc/cart.urdf", "a/b/../cart.urdf"])
def test_a_name_leads_nowhere_else(files, tmp_path, name):
    hand_in(files, name, URDF.encode())
    assert [path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.urdf")] == ["cart.yaml.files/cart.urdf"]


@pytest.mark.parametrize("name", ["..", ".", "/", "", ".hidden", "a\x00b\n", "é" * 300, "日" * 300])
def test_any_name_makes_a_file_name(name, tmp_path):
    made = file_name(name)
    assert made not in ("", ".", "..")
    assert "/" not in made
    (tmp_path / made).write_text("can be written")


def test_no_more_comes_than_there_is_room_for(files, tmp_path, monkeypatch):
    monkeypatch.setattr(received, "MOST_BYTES", len(URDF) + 100)
    hand_in(files, "cart.urdf", URDF.encode())
    with pytest.raises(RobophmError, match=r"table.csv: there is no room for it; .*robophm serve --replay FILE"):
        hand_in(files, "table.csv", TABLE.encode() * 10)
    monkeypatch.setattr(received, "MOST_FILES", 1)
    with pytest.raises(RobophmError, match="1 files are here already"):
        files.begin("more.urdf")
    assert [one.name for one in files.folder.iterdir()] == ["cart.urdf"]


def test_a_file_that_stops_coming_leaves_nothing_behind(files, tmp_path):
    arrival = files.begin("drive.mcap")
    arrival.write(b"half of it")
    arrival.close()
    assert list(tmp_path.iterdir()) == []
