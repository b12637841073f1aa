"""robophm wear, run as a newcomer does."""

import json

import numpy as np
import pytest

ROBOT = """
schema_version: 1
name: courier
usage: {operating: 0.5}
components:
  battery: {rate: 120 FPMH, life: {distribution: weibull, shape: 3.5}}
  computer: {rate: 10 FPMH}
"""


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(ROBOT)
    rng = np.random.default_rng(1)
    t = np.arange(300) * 5.0
    y = 1 - 1e-4 * t + 0.004 * rng.standard_normal(300)
    (tmp_path / "capacity.csv").write_text(
        "time [h],value\n" + "".join(f"{a},{b:.5f}\n" for a, b in zip(t, y, strict=True))
    )
    return path


def test_trend_change_and_remaining_life(inside, robot):
    words = ("wear", robot, "capacity.csv", "--part", "battery", "--threshold", 0.7)
    text = inside(*words)
    assert text.returncode == 0
    assert "battery with its wear" in text.stdout
    said = json.loads(inside(*words, "--json").stdout)
    (found,) = said["signals"]
    assert found["trend"]["low"] < -1e-4 < found["trend"]["high"]
    left = (1 - 1e-4 * 1495 - 0.7) / 1e-4
    assert found["remaining"]["low"] < left < found["remaining"]["high"]
    assert 500 <= found["change"]["alarms"][0] <= 1200  # the baseline ends at 495 h
    lives = said["remaining_life"]
    assert lives["battery"]["fused"]["median"] == pytest.approx(2 * found["remaining"]["median"], rel=0.02)
    assert lives["courier"]["fused"]["median"] < lives["battery"]["fused"]["median"]


def test_a_bend_is_said_wherever_life_is(inside, robot, tmp_path):
    """A capacity that falls ever faster: the stated life is too long, in words and in JSON; a straight one holds."""
    words = ("wear", robot, "capacity.csv", "--part", "battery", "--threshold", 0.7)
    (said,) = json.loads(inside(*words, "--json").stdout)["signals"]
    assert (said["bend"]["direction"], said["bend"]["life_is"]) == (None, "that of a straight trend")
    assert said["bend"]["p"] > said["bend"]["false_alarms"] == 0.05
    text = inside(*words).stdout
    assert "No bend of the trend is told" in text
    assert "what is said of life holds of a straight one alone" in text
    rng = np.random.default_rng(1)
    y = 1 - 1e-7 * (np.arange(300) * 5.0) ** 2 + 0.004 * rng.standard_normal(300)
    (tmp_path / "capacity.csv").write_text("time [h],value\n" + "".join(f"{5 * i},{b:.5f}\n" for i, b in enumerate(y)))
    bent = json.loads(inside(*words, "--json").stdout)
    assert bent["signals"][0]["bend"]["direction"] == "accelerating"
    assert bent["signals"][0]["bend"]["life_is"] == "too long"
    assert [bent["remaining_life"][name]["fused"]["holds"] for name in ("battery", "courier")] == [False, False]
    text = inside(*words).stdout
    assert "The trend bends, it is accelerating" in text
    assert "what is said of life is of a straight one, too long, and does not hold" in " ".join(text.split())
    assert text.count("with its wear, as if it did not bend") == 2


def test_mistakes_are_one_line(inside, robot, tmp_path):
    (tmp_path / "km.csv").write_text("time [km],value\n" + "".join(f"{i},{i}\n" for i in range(9)))
    (tmp_path / "back.csv").write_text("time [h],value\n5,1\n3,2\n")
    (tmp_path / "load.csv").write_text("time [h],value,load\n" + "".join(f"{i},{i},1\n" for i in range(200)))
    (tmp_path / "before.csv").write_text("time [h],value\n-5,1\n3,2\n")
    (tmp_path / "cold.csv").write_text("time [h],value,ambient\n5,1,20\n6,2,\n")
    (tmp_path / "wide.csv").write_text("time [h],value\n" + "".join(f"{i},{i}e300\n" for i in range(150)))
    (tmp_path / "two.yaml").write_text(ROBOT.replace("battery: {", "battery: {quantity: 2, "))
    words = ("--part", "battery", "--threshold", 0.7)
    for some, said in (
        (("before.csv", *words), ":2: time: -5 is negative; expected the age of the part"),
        (("cold.csv", *words), ":3: ambient: is empty; expected a number"),
        (("wide.csv", *words), "a value or the threshold is beyond 1e+60"),
        (("load.csv", *words, "--load", 1), "load.csv: the load does not change in the baseline"),
        (("capacity.csv", "--part", "batery", "--threshold", 1), "no part 'batery'; did you mean 'battery'"),
        (("km.csv", *words), "unit 'km' does not measure what 'h' does"),
        (("back.csv", *words), ":3: time: is no later than the reading before"),
        (("capacity.csv", *words, "--process", "gamma"), "a gamma process never does"),
        (("capacity.csv", *words, "--baseline", 300), "300 readings, and a baseline of 300"),
        (("load.csv", *words), "a column 'load' and --load"),
    ):
        failed = inside("wear", robot, *some)
        assert failed.returncode == 3
        assert said in failed.stderr
        assert failed.stderr.count("\n") == 1
    assert "'battery' is 2 equal parts" in inside("wear", "two.yaml", "capacity.csv", *words).stderr


LISTENS = """
schema_version: 1
name: cart
usage: {operating: 0.5}
components:
  motor:
    rate: 20 FPMH
    wear: {topic: /motor, field: current, every: 10 s, threshold: 8, load: {topic: /motor, field: load, range: [2, 3]}}
  bearing:
    rate: 9 FPMH
    wear: {topic: /t, field: bearing, every: 10 s, threshold: 40, ambient: {topic: /t, field: air}}
  computer: {rate: 2 FPMH}
"""
HOURS = 1200 / 3600  # of the journal


@pytest.fixture
def listening(tmp_path):
    """Twenty minutes in which a current at load rises by 0.5, and a bearing's temperature above the air's by 3."""
    (tmp_path / "robot.yaml").write_text(LISTENS)
    rng = np.random.default_rng(8)
    names = ("/motor.load", "/motor.current", "/t.air", "/t.bearing")
    lines = ["# robophm journal 1\n", *(f"# signal {name}\n" for name in names)]
    for i in range(1200):
        time, load, air = (1_700_000_000 + i) * 10**9, rng.uniform(2, 3.8), 20 + 5 * np.sin(i / 100)
        current = 2 + i / 2400 + 5 * max(load - 3, 0) + 0.1 * rng.standard_normal()
        values = (load, current, air, air + 30 + i / 400 + 0.2 * rng.standard_normal())
        lines += [f"{time} {float(value)!r} {name}\n" for name, value in zip(names, values, strict=True)]
    (tmp_path / "run.journal").write_text("".join(lines))
    return tmp_path / "run.journal"


def test_from_recordings_all_wear_counts_for_the_robot(inside, listening, tmp_path):
    done = inside("wear", "robot.yaml", "run.journal", "--baseline", 40, "--json")
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    found = {one["mode"]: one for one in said["signals"]}
    assert {name: one["readings"] for name, one in found.items()} == {"motor": 120, "bearing": 120}
    assert found["motor"]["trend"]["low"] < 0.5 / HOURS < found["motor"]["trend"]["high"] < 1 / HOURS
    assert found["bearing"]["trend"]["low"] < 3 / HOURS < found["bearing"]["trend"]["high"] < 4 / HOURS
    assert found["bearing"]["remaining"]["low"] < 7 / 3 * HOURS < found["bearing"]["remaining"]["high"]
    lives = said["remaining_life"]
    assert lives["bearing"]["fused"]["median"] == pytest.approx(2 * found["bearing"]["remaining"]["median"], rel=0.02)
    assert lives["cart"]["fused"]["late"] <= min(lives[name]["fused"]["late"] for name in found)
    text = inside("wear", "robot.yaml", "run.journal", "--baseline", 40, "--part", "bearing").stdout
    assert "bearing, mean of /t.bearing above /t.air: 120 readings over 0.33" in text
    assert "h, 2023-11-14 22:" in text  # when it had changed
    assert "motor" not in text
    worn = (tmp_path / "robot.yaml").read_text().replace("threshold: 40", "threshold: 31")
    (tmp_path / "worn.yaml").write_text(worn)
    reached = inside("wear", "worn.yaml", "run.journal", "--baseline", 40, "--part", "bearing")
    assert reached.returncode == 1
    assert "Has reached 31" in reached.stdout


def test_one_signal_that_says_too_little_does_not_hide_the_others(inside, listening):
    text = listening.read_text().splitlines(keepends=True)
    listening.write_text("".join(line for line in text if " /motor.current" not in line or line[:10] < "1700000300"))
    done = inside("wear", "robot.yaml", "run.journal", "--baseline", 40)
    assert done.returncode == 0
    assert (
        "motor, mean of /motor.current at /motor.load 2 … 3: 30 readings, and a baseline of 40 (--baseline)"
        in done.stderr
    )
    assert "bearing with its wear" in done.stdout


@pytest.mark.parametrize("words", [("--threshold", 3), ("--load", 3)], ids=lambda words: words[0])
def test_what_the_design_says_is_not_said_again(inside, listening, words):
    refused = inside("wear", "robot.yaml", listening, *words)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert f"Error: {words[0]}: not used for recordings, whose threshold and load are in the design" in refused.stderr


def test_mistakes_about_recordings_are_one_line(inside, listening, tmp_path):
    (tmp_path / "none.yaml").write_text("schema_version: 1\nname: cart\ncomponents: {a: {rate: 1 FPMH}}\n")
    (tmp_path / "t.csv").write_text("time [h],value\n1,2\n")
    for words, said in (
        (("robot.yaml", listening, "--part", "computer"), "no 'computer' which signal shows its wear"),
        (("none.yaml", listening), "says of no part which signal shows its wear; expected e.g."),
        (("robot.yaml", listening, "--baseline", 500), "120 readings, and a baseline of 500 (--baseline)"),
        (("robot.yaml", "t.csv"), "whose wear is it? expected --part"),
        (("robot.yaml", "t.csv", "--part", "computer"), "at which value is 'computer' worn out? expected --threshold"),
        (("robot.yaml", "t.csv", listening), "is a table, of one signal"),
        (("robot.yaml", "no.mcap"), "no such file"),
    ):
        failed = inside("wear", *words)
        assert failed.returncode == 3, failed.stdout
        assert said in failed.stderr
        assert failed.stderr.count("\n") == 1
