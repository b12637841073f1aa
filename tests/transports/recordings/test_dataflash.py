"""Logs of ArduPilot: what they hold is what pymavlink reads, bit for bit, at the time that the GPS tells."""

from __future__ import annotations

import math
import random
import struct
import time
from pathlib import Path

import pytest
from pymavlink import DFReader

from robophm.core.errors import SourceError
from robophm.transports.recordings.formats.dataflash import NO_UTC, DataFlashRecording
from robophm.transports.recordings.opening import open_source

from ..written.dataflash import GPS, GPS_EPOCH, LEAP, START, defines, gps, head, message

UTC = 1_750_000_000_000
WHOLE = "QbBMhHiIqQa", "TimeUS,b,B,M,h,H,i,I,q,Q,a"
REAL = "QgfdcCeELnNZ", "TimeUS,g,f,d,c,C,e,E,L,n,N,Z"
BAT = "QBfh", "TimeUS,Inst,Volt,Curr"
FMTU = "QBNN", "TimeUS,FmtType,UnitIds,MultIds"


def every(chance: random.Random, stamp: int) -> bytes:
    """Two messages with fields of every type there is."""
    whole = [chance.randrange(-(1 << 7), 1 << 7), chance.randrange(1 << 8), chance.randrange(1 << 7)]
    whole += [chance.randrange(-(1 << 15), 1 << 15), chance.randrange(1 << 16)]
    whole += [chance.randrange(-(1 << 31), 1 << 31), chance.randrange(1 << 32)]
    whole += [chance.randrange(-(1 << 63), 1 << 63), chance.randrange(1 << 64)]
    array = [chance.randrange(-(1 << 15), 1 << 15) for _ in range(32)]
    real = [chance.uniform(-9, 9), chance.uniform(-9, 9), chance.choice([math.nan, chance.uniform(-9, 9)])]
    scaled = [chance.randrange(-(1 << 15), 1 << 15), chance.randrange(1 << 16)]
    scaled += [chance.randrange(-(1 << 31), 1 << 31), chance.randrange(1 << 32), chance.randrange(-(1 << 31), 1 << 31)]
    texts = [b"text", b"longer text", b"the longest text"]
    return message(130, WHOLE[0], stamp, *whole, *array) + message(133, REAL[0], stamp, *real, *scaled, *texts)


def flight(seconds: int = 20, *, fixed: bool = True) -> bytes:
    """A flight with numbers of every type and two batteries at 2 Hz, and a GPS at 1 Hz that once is an hour wrong."""
    chance = random.Random(seconds)
    log = [head(GPS=GPS, WHOL=WHOLE, BAT=BAT, FMTU=FMTU, REAL=REAL), message(132, FMTU[0], 1, 131, b"s#vA", b"F---")]
    for step in range(2 * seconds):
        stamp = START + step * 500_000
        log.append(every(chance, stamp))
        for number in (0, 1):
            log.append(message(131, BAT[0], stamp + 10, number, chance.uniform(9, 12), step))
        if step % 2 == 0:
            utc = UTC + stamp // 1000 + (3_600_000 if step == 6 else 0)
            log.append(gps(129, stamp + 400, utc, status=3 if fixed and step > 2 else 1))
    return b"".join(log)


@pytest.fixture
def flown(tmp_path: Path) -> Path:
    path = tmp_path / "flight.BIN"
    path.write_bytes(flight())
    return path


def read_by_peer(path: Path) -> list[DFReader.DFMessage]:
    """All messages of a log as pymavlink reads them."""
    peer = DFReader.DFReader_binary(str(path))
    try:
        return [*iter(peer.recv_msg, None)]
    finally:
        peer.close()
        peer.filehandle.close()


def values(found) -> list[bytes]:
    return [struct.pack("<d", one.value) for one in found]


def test_all_values_are_those_of_pymavlink_bit_for_bit(flown: Path) -> None:
    messages = read_by_peer(flown)
    compared = 0
    with open_source(flown) as source:
        for info in source.topics():
            name, _, instance = info.topic[1:].partition("_")
            theirs = [one for one in messages if one.get_type() == name]
            theirs = [one for one in theirs if name != "BAT" or one.Inst == int(instance or 0)]
            assert len(theirs) == info.messages
            for field in info.fields:
                array = field.endswith("[]")
                for index in range(32) if array else (None,):
                    signal = f"{info.topic}.{field[:-2]}[{index}]" if array else f"{info.topic}.{field}"
                    found = list(source.samples([signal]))
                    read = [getattr(one, field.removesuffix("[]")) for one in theirs]
                    expected = [float(one if index is None else one[index]) for one in read]
                    assert values(found) == [struct.pack("<d", one) for one in expected]
                    compared += len(found)
        topics = {info.topic: info for info in source.topics()}
    assert list(topics) == ["/BAT", "/BAT_1", "/FMTU", "/GPS", "/REAL", "/WHOL"]
    assert topics["/WHOL"].fields == ("TimeUS", *"bBMhHiIqQ", "a[]")
    assert topics["/REAL"].fields == ("TimeUS", *"gfdcCeEL")
    assert compared > 40 * 50


def test_its_time_is_utc_by_the_median_of_the_fixes(flown: Path) -> None:
    with open_source(flown) as source:
        times = [one.time for one in source.samples(["/REAL.d"])]
        assert not source.notes
    # a GPS that tells whole milliseconds, 400 µs late
    assert times == [(UTC * 1000 + START - 400 + step * 500_000) * 1000 for step in range(40)]
    first = next(one for one in read_by_peer(flown) if one.get_type() == "REAL")
    assert first._timestamp == pytest.approx(times[0] / 1e9, abs=2)


def test_without_a_fix_that_is_said(tmp_path: Path) -> None:
    path = tmp_path / "flight.BIN"
    path.write_bytes(flight(fixed=False))
    source = open_source(path)
    assert next(source.samples(["/REAL.d"])).time == START * 1000
    assert source.notes == {NO_UTC: 1}


def test_logs_of_before_2015_count_milliseconds(tmp_path: Path) -> None:
    path = tmp_path / "flight.BIN"
    old = "BIHI", "Status,TimeMS,Week,T"
    week, within = divmod(UTC - (GPS_EPOCH - LEAP) * 1000, 7 * 24 * 3600 * 1000)
    log = [head(GPS=old, CURR=("Ih", "TimeMS,Volt"), ACC1=("IIf", "TimeMS,TimeUS,AccX"))]
    for step in range(3):
        log.append(message(129, old[0], 3, within + step, week, 5000 + step))
        log.append(message(130, "Ih", 5000 + step, 1200) + message(131, "IIf", 5000 + step, 7, 0.5))
    path.write_bytes(b"".join(log))
    with open_source(path) as source:
        for signal in ("/CURR.Volt", "/ACC1.AccX", "/GPS.Week"):
            assert [one.time for one in source.samples([signal])] == [(UTC + step) * 10**6 for step in range(3)]
    assert read_by_peer(path)[-1]._timestamp == pytest.approx((UTC + 2) / 1000, abs=1)


def test_a_message_that_is_defined_anew_is_read_as_it_is_then(tmp_path: Path) -> None:
    path = tmp_path / "flight.BIN"
    again = defines(131, "BAT", "Qfd", "TimeUS,Volt,Temp")
    path.write_bytes(flight(2) + again + message(131, "Qfd", START, 7.5, 30.0))
    with open_source(path) as source:
        assert next(one.value for one in source.samples(["/BAT.Volt"])) == 7.5
        assert len(list(source.samples(["/BAT.Volt"]))) == 5
        assert {info.topic: info.fields for info in source.topics()}["/BAT"] == ("TimeUS", "Volt")


def test_what_is_cut_or_lost_is_said_and_the_rest_read(tmp_path: Path) -> None:
    whole, path = flight(), tmp_path / "flight.BIN"
    path.write_bytes(whole + bytes(1000))  # a memory that is not full
    source = open_source(path)
    assert len(list(source.samples(["/REAL.d"]))) == 40
    assert not source.notes
    path.write_bytes(whole[:-5])
    source = open_source(path)
    list(source.samples(["/BAT.Volt"]))
    assert source.notes == {
        "damaged, and read as far as it is whole": 1,
        "bytes of a log that belong to no message": 18 - 5,
    }
    broken = len(whole) // 2
    path.write_bytes(whole[:broken] + b"\x01" * 40 + whole[broken:])
    source = open_source(path)
    assert 38 <= len(list(source.samples(["/REAL.d"]))) <= 40
    assert source.notes["damaged, and read as far as it is whole"] == 1
    path.write_bytes(whole[50:])  # its first format is cut
    assert len(list(open_source(path).samples(["/REAL.d"]))) == 40


NONE = {
    "formats alone": (head(GPS=GPS), "holds no messages"),
    "a format that contradicts itself": (
        head(GPS=GPS) + defines(140, "BAD", "Qf", "TimeUS") + message(140, "Qf", 1, 1.0),
        "holds no messages",
    ),
    "messages without a time": (
        head(GPS=GPS, BAT=("If", "Count,Volt")) + message(130, "If", 5, 1.0),
        "holds no messages",
    ),
    "times beyond all": (
        head(GPS=GPS, BAT=("Qf", "TimeUS,Volt")) + message(130, "Qf", 1 << 63, 1.0),
        "holds no messages",
    ),
}


@pytest.mark.parametrize(("content", "says"), NONE.values(), ids=NONE)
def test_what_is_no_log_is_refused_in_one_line(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "flight.BIN"
    path.write_bytes(content)
    with pytest.raises(SourceError, match=says) as raised:
        open_source(path)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("filling", [b"\xa3\x95", b"\xa3\x95\x80"], ids=repr)
def test_megabytes_of_what_may_begin_messages_take_no_minutes(filling: bytes, tmp_path: Path) -> None:
    path = tmp_path / "flight.BIN"
    path.write_bytes(flight() + filling * ((1 << 24) // len(filling)))
    begun = time.process_time()
    with open_source(path) as source:
        next(iter(source.columns(["/BAT.Volt"], 0)))
        assert source.notes["bytes of a log that belong to no message"] > 1 << 23
    assert time.process_time() - begun < 8  # a quarter of a minute, if each place were tried by itself


@pytest.mark.parametrize("text", ["abcd", "a,b"])
def test_more_definitions_than_are_believed_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "flight.BIN"
    anew = b"".join(defines(140, name, letters, labels) for name, letters, labels in
        [("X", "QB", "TimeUS,a"), ("X", "QBB", f"TimeUS,{text}")] * 3000)  # fmt: skip
    path.write_bytes(flight() + anew)
    with pytest.raises(SourceError, match=f"{path}: cannot be read: has messages of more than 4096 kinds or senders"):
        open_source(path)


def test_hundreds_of_damaged_logs_are_read_or_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    chance, whole = random.Random(5), flight(2)
    path = tmp_path / "flight.BIN"
    read = 0
    for _ in range(100):
        damaged = bytearray(whole[: chance.randrange(40, len(whole))])
        for _ in range(chance.randrange(6)):
            damaged[chance.randrange(len(damaged))] = chance.randrange(256)
        path.write_bytes(damaged)
        try:
            source = DataFlashRecording(path)
            for info in source.topics():
                field = info.fields[-1].replace("[]", "[0]")
                read += sum(1 for _ in source.samples([f"{info.topic}.{field}"]))
        except SourceError as error:
            assert str(error).startswith(str(path))  # noqa: PT017
            assert "\n" not in str(error)  # noqa: PT017
    assert read > 100
    assert capfd.readouterr() == ("", "")
