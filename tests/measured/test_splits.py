"""Many files that are one drive are listed as the one file is, whatever they are called; what is not alike is not."""

from dataclasses import asdict

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

from robophm.core.signal import SECOND
from robophm.measured.overview import overview
from robophm.measured.recordings import recordings
from robophm.measured.splits import NAMING, drives_of, splits_of

from .plain import START, write

EVERY = 20


def cut(whole, folder, every, name="drive_{}.mcap"):
    """Files of so long a time each; the topics of each are those that it has messages of."""
    folder.mkdir()
    writer, out, last = None, None, None
    with whole.open("rb") as file:
        for schema, channel, one in make_reader(file).iter_messages():
            number = (one.log_time - START) // (every * SECOND)
            if number != last:
                if writer:
                    writer.finish()
                    out.close()
                out = (folder / name.format(number)).open("wb")
                writer, last, ids = Writer(out), number, {}
                writer.start(profile="ros2")
            if channel.topic not in ids:
                id_ = writer.register_schema(schema.name, schema.encoding, schema.data)
                ids[channel.topic] = writer.register_channel(channel.topic, channel.message_encoding, id_)
            writer.add_message(ids[channel.topic], one.log_time, one.data, one.publish_time)
    writer.finish()
    out.close()
    return folder


def temperatures(seconds, begin=0, level=(), value=1.0):
    """A temperature a second, and numbers at some of those times."""
    messages = [(START + (begin + i) * SECOND, START + (begin + i) * SECOND, value) for i in range(seconds)]
    return messages + [(START + (begin + i) * SECOND, None, 1.0) for i in level]


def listed(*paths):
    return splits_of(recordings(paths))


@pytest.mark.parametrize("files", [3, NAMING + 20])
def test_a_drive_in_many_files_is_listed_as_the_one_file(tmp_path, files):
    seconds = files * EVERY
    whole = write(tmp_path / "whole.mcap", temperatures(seconds, level=[0, 22, 23, seconds - 1]), 200)
    (some,) = listed(cut(whole, tmp_path / "cut", EVERY))
    (one,) = listed(whole)
    assert [asdict(topic) for topic in some.seen.topics] == [asdict(topic) for topic in one.seen.topics]
    assert [asdict(topic) for topic in one.seen.topics] == [
        asdict(topic) for topic in overview(*recordings([whole])).topics
    ]
    assert (some.seen.span, some.seen.notes) == (one.seen.span, one.seen.notes)
    folder = tmp_path / "cut"
    in_time = [str(folder / f"drive_{number}.mcap") for number in range(files)]  # _10 behind _9
    assert some.files == (*in_time,)
    assert some.seen.name == f"{files} files, {folder / 'drive_0.mcap'} … drive_{files - 1}.mcap"
    assert some.with_topic == {"/motor/temperature": files, "/level": 3}
    assert one.with_topic == {"/motor/temperature": 1, "/level": 1}


def test_short_files_of_slow_topics_are_one(tmp_path):
    """Of messages a second apart in files of three seconds a third of the time is between files."""
    whole = write(tmp_path / "whole.mcap", temperatures(30))
    (some,) = listed(cut(whole, tmp_path / "cut", 3))
    assert (len(some.files), some.seen.topics[0].messages, some.seen.topics[0].gap_count) == (10, 30, 0)


def test_what_does_not_follow_or_is_called_otherwise_is_listed_by_itself(tmp_path):
    whole = write(tmp_path / "whole.mcap", temperatures(6 * EVERY))
    folder = cut(whole, tmp_path / "cut", EVERY)
    (folder / "drive_1.mcap").unlink()
    (folder / "drive_4.mcap").rename(folder / "arm.mcap")
    found = listed(folder)
    assert [[file.rpartition("/")[2] for file in one.files] for one in found] == [
        ["arm.mcap"], ["drive_0.mcap"], ["drive_2.mcap", "drive_3.mcap"], ["drive_5.mcap"],
    ]  # fmt: skip
    assert [one.seen.topics[-1].messages for one in found] == [EVERY, EVERY, 2 * EVERY, EVERY]


def test_drives_of_several_robots_are_not_mixed(tmp_path):
    """At the same time, with the same topics, under names that differ in numbers alone; and other topics."""
    folder = tmp_path / "drives"
    folder.mkdir()
    for robot in (1, 2):
        for number in range(3):
            begin = (number + robot - 1) * EVERY  # one begins when a file of the other's ends
            write(folder / f"robot{robot}_{number}.mcap", temperatures(EVERY, begin, value=float(robot)))
    found = listed(folder)
    assert [[file[-13:-5] for file in one.files] for one in found] == [
        [f"robot{robot}_{number}"[-8:] for number in range(3)] for robot in (1, 2)
    ]


def test_a_damaged_file_of_many_is_named(tmp_path):
    folder = cut(write(tmp_path / "whole.mcap", temperatures(9 * EVERY)), tmp_path / "cut", EVERY)
    middle = folder / "drive_4.mcap"
    middle.write_bytes(middle.read_bytes()[:-60])
    shown = listed(folder)
    assert sum(one.seen.topics[-1].messages for one in shown) == 9 * EVERY
    assert any("drive_4.mcap" in note for one in shown for note in one.seen.notes)
    (folder / "drive_5.mcap").write_bytes(b"")
    assert any("drive_5.mcap" in note for one in listed(folder) for note in one.seen.notes)


def test_drives_are_those_that_are_listed(tmp_path):
    whole = write(tmp_path / "whole.mcap", temperatures(200), 200)
    parts = cut(whole, tmp_path / "cut", EVERY)
    other = write(tmp_path / "other.mcap", temperatures(50, begin=5000), 200)
    drive, alone = drives_of(recordings([parts, other]))
    assert [path.name for path in drive.paths] == [f"drive_{number}.mcap" for number in range(10)]
    assert drive.name == f"10 files, {parts / 'drive_0.mcap'} … drive_9.mcap"
    assert alone == recordings([other])[0]
    assert drives_of(recordings([whole])) == recordings([whole])
