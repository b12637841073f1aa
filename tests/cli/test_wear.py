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
    assert found["followed"]
    assert found["reached"] is None
    lives = said["remaining_life"]
    assert lives["battery"]["fused"]["median"] == pytest.approx(2 * found["remaining"]["median"], rel=0.02)
    assert lives["courier"]["fused"]["median"] < lives["battery"]["fused"]["median"]


def readings(path, times, values, heading="time [h],value"):
    path.write_text(heading + "\n" + "".join(f"{a},{b}\n" for a, b in zip(times, values, strict=True)))
    return path.name


def test_a_change_is_told_and_what_its_alarms_promise(inside, robot, tmp_path):
    """From 500 h on; a baseline that follows itself, or is too short, promises nothing, in words and in JSON."""
    rng = np.random.default_rng(1)
    hours = np.arange(300) * 5.0
    readings(tmp_path / "later.csv", hours, 1 - 1e-4 * np.maximum(hours - 500, 0) + 0.004 * rng.standard_normal(300))
    words = ("--part", "battery", "--threshold", 0.7)
    change = json.loads(inside("wear", robot, "later.csv", *words, "--json").stdout)["signals"][0]["change"]
    assert 500 <= change["alarms"][0] <= 700
    assert change["between_false_alarms"] == 1000
    assert "falsely once in 1000 while all is as then" in inside("wear", robot, "later.csv", *words).stdout
    change = json.loads(inside("wear", robot, "capacity.csv", *words, "--json").stdout)["signals"][0]["change"]
    assert change["between_false_alarms"] is None
    assert "how often falsely cannot be promised" in inside("wear", robot, "capacity.csv", *words).stdout
    readings(tmp_path / "few.csv", range(12), 1 - 0.01 * np.arange(12))
    few = inside("wear", robot, "few.csv", *words)
    assert few.returncode == 0
    assert "Change: not looked for: 12 readings, and a baseline needs 100 before the first one judged" in few.stdout
    assert "Reaches 0.7 in 1" in few.stdout  # some 19 h
    assert json.loads(inside("wear", robot, "few.csv", *words, "--json").stdout)["signals"][0]["change"] == {
        "not_looked_for": "12 readings, and a baseline needs 100 before the first one judged"
    }


def test_wear_that_no_model_follows_is_said_and_changes_the_exit_code(inside, robot, tmp_path):
    """A knee of which nothing was to be seen; the life is said, and that it is not to be believed."""
    rng = np.random.default_rng(1)
    hours = np.arange(300) * 5.0
    y = 1 - 1e-4 * hours - 0.02 * np.maximum(np.arange(300) - 294, 0) + 0.004 * rng.standard_normal(300)
    words = ("wear", robot, readings(tmp_path / "knee.csv", hours, y), "--part", "battery", "--threshold", 0.5)
    done = inside(*words)
    assert done.returncode == 1
    assert "No model follows this wear" in done.stdout
    assert done.stdout.count("with its wear, which no model follows") == 2
    said = json.loads(inside(*words, "--json").stdout)
    assert not said["signals"][0]["followed"]
    assert [said["remaining_life"][name]["fused"]["holds"] for name in ("battery", "courier")] == [False, False]


def test_a_threshold_that_was_reached_is_said_with_its_date_wherever_it_recovered(inside, robot, tmp_path):
    capacity = [1.0, 0.95, 0.9, 0.85, 0.8, 0.75, 0.69, 0.68, 0.67, 0.74, 0.73, 0.72]
    dates = [f"2024-03-{1 + i:02}" for i in range(12)]
    words = ("--part", "battery", "--threshold", 0.7)
    for last, rested in ((9, ""), (12, "; short of it again since 216 h, 2024-03-10 00:00:00, and had reached it")):
        name = readings(tmp_path / "rest.csv", dates[:last], capacity[:last], "when,value")
        done = inside("wear", robot, name, *words)
        assert done.returncode == 1
        assert f"Has reached 0.7 at 140 h, 2024-03-06 20:00:00{rested}" in done.stdout
        said = json.loads(inside("wear", robot, name, *words, "--json").stdout)
        assert said["signals"][0]["reached"] == pytest.approx(140)
        assert said["signals"][0]["recovered"] == (216 if rested else None)
        assert said["remaining_life"]["battery"]["fused"]["median"] == 0
    rng = np.random.default_rng(3)
    wear = 0.1 * np.r_[np.arange(12), np.arange(8)] + 0.01 * rng.standard_normal(20)
    done = inside("wear", robot, readings(tmp_path / "new.csv", range(20), 1 - wear), "--part", "battery",
                  "--threshold", 0.05)  # fmt: skip
    assert done.returncode == 0
    assert "Wear fell back at once: 12 h" in done.stdout
    assert "As if new since 12 h" in done.stdout
    assert "Had reached 0.05 at 9." in done.stdout
    assert "before it was as if new; reaches 0.05 in" in done.stdout


def test_an_uncertain_threshold_is_said_and_widens_life(inside, robot, tmp_path):
    words = ("wear", robot, "capacity.csv", "--part", "battery", "--threshold", 0.7, "--threshold-deviation")
    sharp, wide = (json.loads(inside(*words, one, "--json").stdout)["signals"][0] for one in (0, 0.05))
    assert wide["threshold_deviation"] == 0.05
    left = [one["remaining"]["high"] - one["remaining"]["low"] for one in (sharp, wide)]
    assert left[1] > 1.3 * left[0]
    assert "Reaches 0.7 ± 0.05 in" in inside(*words, 0.05).stdout
    assert "± 0.05" not in inside(*words, 0).stdout


CRACK = (0.90, 0.94, 0.98, 1.03, 1.07, 1.12, 1.19, 1.24, 1.34, 1.43, 1.55, 1.71)
"""A specimen of Alloy-A (Meeker and Escobar 1998, table C.14) [inch]."""


@pytest.mark.full
def test_what_would_have_been_said_earlier(inside, robot, tmp_path):
    """Words, JSON and a file that calibrate reads agree; where nothing was reached, with where it is now."""
    words = ("wear", robot, readings(tmp_path / "crack.csv", range(12), CRACK), "--part", "battery", "--threshold", 1.6)
    text = inside(*words, "--backtest")
    assert text.returncode == 1  # reached
    assert "what would have been said of when 1.6 would be reached; it was at 10.31 h" in text.stdout
    assert "of 90 % held; relative accuracy 0." in text.stdout
    found = json.loads(inside(*words, "--backtest", "--predictions", "p.csv", "--json").stdout)
    done = found["signals"][0]["backtest"]
    assert done["end"] == pytest.approx(10 + 0.05 / 0.16)
    held = [cut["remaining"]["low"] <= cut["left"] <= cut["remaining"]["high"] for cut in done["cuts"]]
    assert [cut["held"] for cut in done["cuts"]] == held
    assert done["coverage"] == pytest.approx(np.mean(held))
    off = [abs(cut["remaining"]["median"] - cut["left"]) / cut["left"] for cut in done["cuts"]]
    assert done["relative_accuracy"] == pytest.approx(1 - np.mean(off))
    scored = inside("calibrate", "p.csv", "--json")
    assert scored.returncode == 0, scored.stderr
    prognosis = json.loads(scored.stdout)["models"][0]["lives"]["prognosis"]
    assert prognosis["relative_accuracy"] == pytest.approx(done["relative_accuracy"])
    assert "backtest" not in json.loads(inside(*words, "--json").stdout)["signals"][0]
    text = inside(*words[:-1], 9, "--backtest").stdout
    assert "of when it would be where it is now, at 1.55; it was first there at 10 h" in text


def test_backtests_that_cannot_be(inside, robot, tmp_path):
    name = readings(tmp_path / "few.csv", range(5), [1, 0.95, 0.9, 0.3, 0.2])
    failed = inside("wear", robot, name, "--part", "battery", "--threshold", 0.7, "--backtest")
    assert failed.returncode == 3
    assert failed.stderr == "error: few.csv: fewer than 4 readings before 0.7 was reached: expected more of them\n"
    assert failed.stdout == ""
    refused = inside("wear", robot, name, "--part", "battery", "--threshold", 0.7, "--predictions", name)
    assert "is read or kept by this command too" in refused.stderr


def test_what_cannot_be_said_is_no_number(inside, robot, tmp_path):
    """A signal that goes away from its threshold, and one that stands: no infinity, in words or in JSON."""
    rng = np.random.default_rng(2)
    for slope, leads in ((0.02, True), (0.0, False)):
        y = 5 + slope * np.arange(60) + 0.02 * rng.standard_normal(60)
        words = ("wear", robot, readings(tmp_path / "y.csv", range(60), y), "--part", "battery", "--threshold", 4)
        done = inside(*words)
        assert done.returncode == 0, done.stderr
        assert "No trend shows yet that leads to 4: when it is reached cannot be said; its hazard rate" in done.stdout
        assert ("its trend leads away from there, or it was past 4 when readings began" in done.stdout) == leads
        assert "∞" not in done.stdout
        found = json.loads(inside(*words, "--json").stdout)
        lives = found["remaining_life"]["battery"]
        assert lives["fused"]["median"] == pytest.approx(lives["hazard"]["median"], rel=1e-9)
        assert "Infinity" not in json.dumps(found)
        assert (found["signals"][0]["said"], found["signals"][0]["trend_shows"]) == (False, False)
        assert set(found["signals"][0]["remaining"].values()) == {None}


def test_mistakes_are_one_line(inside, robot, tmp_path):
    (tmp_path / "km.csv").write_text("time [km],value\n" + "".join(f"{i},{i}\n" for i in range(9)))
    (tmp_path / "back.csv").write_text("time [h],value\n5,1\n3,2\n")
    (tmp_path / "load.csv").write_text("time [h],value,load\n" + "".join(f"{i},{i},1\n" for i in range(200)))
    (tmp_path / "before.csv").write_text("time [h],value\n-5,1\n3,2\n")
    (tmp_path / "cold.csv").write_text("time [h],value,ambient\n5,1,20\n6,2,\n")
    (tmp_path / "wide.csv").write_text("time [h],value\n" + "".join(f"{i},{i}e300\n" for i in range(150)))
    (tmp_path / "one.csv").write_text("time [h],value\n5,1\n")
    (tmp_path / "equal.csv").write_text("time [h],value\n5,1\n5,2\n")
    (tmp_path / "units.csv").write_text("unit,time [h],value\nA,5,1\nB,6,2\n")
    (tmp_path / "nan.csv").write_text("time [h],value\n5,1\n6,nan\n")
    readings(tmp_path / "past.csv", range(40), np.r_[0.6, 1.0 - 0.001 * np.arange(39)])
    readings(tmp_path / "at.csv", range(9), np.r_[0.7, 0.7, 0.7, np.arange(6)])
    readings(tmp_path / "still.csv", range(9), np.ones(9))
    (tmp_path / "both.csv").write_text("when,time [h],value\n2026-01-01,0,1\n2026-01-02,24,0.9\n")
    (tmp_path / "late.csv").write_text("when,value\n2026-01-01,1\n9000-01-01,0.9\n")
    readings(
        tmp_path / "hot.csv", range(9), [f"{1 - k / 99},40" for k in range(9)], "time [h],value,temperature [degC]"
    )
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
        (("one.csv", *words), "one.csv: 1 reading: when a threshold is reached cannot be said; expected at least 4"),
        (("equal.csv", *words), ":3: time: is no later than the reading before; expected readings of one part"),
        (("units.csv", *words), ":3: unit: is 'B', and 'A' before; expected readings of one part"),
        (("nan.csv", *words), ":3: value: 'nan' is not a finite number"),
        (("past.csv", *words), "past.csv: the first reading is at or past the threshold already"),
        (("at.csv", *words), "at.csv: the signal begins at its threshold, 0.7"),
        (("still.csv", *words), "still.csv: the signal is 1 all the time: no trend"),
        (("load.csv", *words), "a column 'load', and --load"),
        (("both.csv", *words), "both.csv:2: has a time and a date; expected one of the two columns"),
        (("late.csv", *words), "late.csv:3: when: '9000-01-01' is no date of a reading"),
        (("hot.csv", *words, "--use", "stress=3"), "hot.csv: readings have no column stress"),
    ):
        failed = inside("wear", robot, *some)
        assert failed.returncode == 3
        assert said in failed.stderr
        assert failed.stderr.count("\n") == 1
    text = inside("wear", robot, "hot.csv", *words, "--use", "temperature=90").stdout
    assert "Readings are at temperature 40: what is said of 90 rests on its law alone" in text
    assert "its law alone" not in inside("wear", robot, "hot.csv", *words).stdout
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


@pytest.mark.full
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
    motor, fused = found["motor"], lives["motor"]["fused"]
    assert motor["said"]
    assert fused["median"] == pytest.approx(2 * motor["remaining"]["median"], rel=0.02)
    # Of the share that never comes there the hazard is left, 20 FPMH at half use: all that survives for so long.
    late = -np.log(0.05 / motor["never"]) / 1e-5 if motor["never"] > 0.05 else 2 * motor["remaining"]["high"]
    assert fused["late"] == pytest.approx(late, rel=0.05)
    assert lives["cart"]["fused"]["late"] <= lives["bearing"]["fused"]["late"]
    text = inside("wear", "robot.yaml", "run.journal", "--baseline", 40, "--part", "bearing").stdout
    assert "bearing, mean of /t.bearing above /t.air: 120 readings over 0.33" in text
    assert "motor" not in text
    worn = (tmp_path / "robot.yaml").read_text().replace("threshold: 40", "threshold: 31")
    (tmp_path / "worn.yaml").write_text(worn)
    reached = inside("wear", "worn.yaml", "run.journal", "--baseline", 40, "--part", "bearing")
    assert reached.returncode == 1
    assert "Has reached 31 at 0.1" in reached.stdout
    assert "h, 2023-11-14 22:" in reached.stdout


def test_a_csv_whose_columns_are_signals_is_a_recording(inside, listening, tmp_path):
    """The same samples say the same; a table of readings is still one."""
    cells = [line.split() for line in listening.read_text().splitlines() if line[0] != "#"]
    rows = [cells[i : i + 4] for i in range(0, len(cells), 4)]
    lines = [",".join([f"{row[0][0][:-9]}.0", *(value for _, value, _ in row)]) for row in rows]
    heading = "time," + ",".join(name for _, _, name in rows[0])
    (tmp_path / "run.csv").write_text("\n".join([heading, *lines]) + "\n")
    words = ("--part", "bearing", "--baseline", 40, "--json")
    as_csv, as_journal = (inside("wear", "robot.yaml", name, *words) for name in ("run.csv", listening))
    assert as_csv.returncode == 0, as_csv.stderr
    assert json.loads(as_csv.stdout) == json.loads(as_journal.stdout)


def test_one_signal_that_says_too_little_does_not_hide_the_others(inside, listening):
    text = listening.read_text().splitlines(keepends=True)
    listening.write_text("".join(line for line in text if " /motor.current" not in line or line[:10] < "1700000030"))
    done = inside("wear", "robot.yaml", "run.journal", "--baseline", 40)
    assert done.returncode == 0
    assert "motor, mean of /motor.current at /motor.load 2 … 3: 3 readings: when a threshold is reached" in done.stderr
    assert "bearing with its wear" in done.stdout


@pytest.mark.parametrize(
    "words", [("--threshold", 3), ("--threshold-deviation", 3), ("--load", 3)], ids=lambda words: words[0]
)
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
        (("robot.yaml", "t.csv"), "whose wear is it? expected --part"),
        (("robot.yaml", "t.csv", "--part", "computer"), "at which value is 'computer' worn out? expected --threshold"),
        (("robot.yaml", "t.csv", listening), "is a table, of one signal"),
        (("robot.yaml", "no.mcap"), "no such file"),
    ):
        failed = inside("wear", *words)
        assert failed.returncode == 3, failed.stdout
        assert said in failed.stderr
        assert failed.stderr.count("\n") == 1


def fleet(path, rng, count, heading="unit,time [h],value"):
    """Batteries whose capacity falls ever faster, each at a speed of its own, until it is below 0.7."""
    rows = []
    for unit, life in enumerate(2000 * np.exp(0.2 * rng.standard_normal(count))):
        t = np.arange(0.0, 1.05 * life, 20.0)
        y = 1 - 0.3 * (t / life) ** 3 + 0.002 * rng.standard_normal(len(t))
        rows += [f"b{unit},{a},{b:.5f}" for a, b in zip(t, y, strict=True)]
    path.write_text(heading + "\n" + "\n".join(rows) + "\n")
    return path.name


@pytest.mark.full
def test_others_of_its_kind_are_teachers(inside, robot, tmp_path):
    """At half of its life a battery that will fall ever faster; thirty others tell when, and that is said."""
    rng = np.random.default_rng(11)
    hours = np.arange(0.0, 1000.0, 20.0)
    readings(tmp_path / "mine.csv", hours, 1 - 0.3 * (hours / 2000) ** 3 + 0.002 * rng.standard_normal(50))
    words = ("wear", robot, "mine.csv", "--part", "battery", "--threshold", 0.7)
    others = fleet(tmp_path / "fleet.csv", rng, 30)
    alone, among = (
        json.loads(inside(*words, *more, "--json").stdout)["signals"][0] for more in ((), ("--fleet", others))
    )
    assert among["others"] == 30
    assert alone["others"] == 0
    assert sum(among["weights"].values()) == pytest.approx(1)
    left = 2000 - hours[-1]
    assert among["remaining"]["low"] < left < among["remaining"]["high"]
    assert abs(among["remaining"]["median"] / left - 1) < 0.25
    told = inside(*words, "--fleet", others)
    assert told.returncode == 0
    assert "Beside 30 others of its kind" in told.stdout
    backtests = [json.loads(inside(*words, *more, "--backtest", "--json").stdout)["signals"][0]["backtest"]
                 for more in ((), ("--fleet", others))]  # fmt: skip
    assert backtests[1]["relative_accuracy"] > backtests[0]["relative_accuracy"]
    assert "others from here" in told.stdout


def test_what_is_no_fleet(inside, robot, tmp_path):
    words = ("wear", robot, "capacity.csv", "--part", "battery", "--threshold", 0.7, "--fleet")
    for text, expected in (
        ("time [h],value\n1,0.9\n2,0.8\n", "fleet.csv:2: which part is it of? expected a column 'unit'"),
        ("unit,time [h],value\na,1,0.9\nb,1,0.9\nb,2,0.8\n", "unit 'a' has one reading; expected at least two"),
        ("unit,time [h],value\na,2,0.9\na,1,0.8\n", "is no later than the reading before"),
        (
            "unit,when,value\na,2026-01-01T00:00:00Z,0.9\na,2026-01-02T00:00:00Z,0.8\n",
            "unit 'a' has dates or ages where",
        ),
        ("unit,time [h],value,load\na,1,0.9,3\na,2,0.8,4\n", "come with a load are not compared"),
        ("unit,time [h],value\na,1,0.9\na,2,0.6\nb,1,0.6\nb,2,0.5\n", "unit 'b' of the others is past the threshold"),
        ("unit,time [h],value\na,1,0.6\na,2,0.5\nb,1,0.6\nb,2,0.5\n", "the others all begin beyond the threshold"),
    ):
        (tmp_path / "fleet.csv").write_text(text)
        told = inside(*words, "fleet.csv")
        assert told.returncode == 3
        assert expected in " ".join(told.stderr.split())


def test_a_fleet_beside_recordings(inside, listening, tmp_path):
    """Bearings whose rise above the air came to 40 K after 1.5 h; of several parts one must be chosen."""
    rows = [f"b{k},{t:.3f},{30 + 10 * t / life:.4f}" for k, life in enumerate((1.4, 1.5, 1.6)) for t in
            np.arange(0.0, life * 1.02, 0.02)]  # fmt: skip
    (tmp_path / "bearings.csv").write_text("unit,time [h],value\n" + "\n".join(rows) + "\n")
    words = ("wear", "robot.yaml", listening, "--baseline", 40, "--fleet", "bearings.csv")
    refused = inside(*words)
    assert refused.returncode == 3
    assert "of which part are these others? expected --part" in refused.stderr
    (found,) = json.loads(inside(*words, "--part", "bearing", "--json").stdout)["signals"]
    assert found["others"] == 3
    assert found["remaining"]["low"] < 7 / 3 * HOURS < found["remaining"]["high"]
