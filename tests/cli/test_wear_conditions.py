"""robophm wear of readings that come with conditions, and of many signals by an index, run as a newcomer does."""

import json
import re

import numpy as np
import pytest

ROBOT = """
schema_version: 1
name: courier
components:
  battery: {rate: 120 FPMH, life: {distribution: weibull, shape: 3.5}}
"""


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(ROBOT)
    return path


def test_conditions_of_readings_and_to_come(inside, robot, tmp_path):
    """The part's own clock runs exp(0.7/k·(1/313 − 1/333)) = 4.7 times as fast at 60 °C as it did at 40 °C, as far as
    is known without others."""
    hours = np.arange(60) * 10.0
    rows = [f"{t},{1 - 2e-4 * t},40" for t in hours]
    (tmp_path / "warm.csv").write_text("time [h],value,temperature [degC]\n" + "\n".join(rows) + "\n")
    words = ("wear", robot, "warm.csv", "--part", "battery", "--threshold", 0.7)
    same, hotter = (
        json.loads(inside(*words, *more, "--json").stdout)["signals"][0] for more in ((), ("--use", "temperature=60"))
    )
    assert same["conditions_to_come"] == {"temperature": 40}
    factor = np.exp(0.7 / 8.617333e-5 * (1 / 313.15 - 1 / 333.15))
    assert same["remaining"]["median"] / hotter["remaining"]["median"] == pytest.approx(factor, rel=0.1)
    assert "As it would be at temperature 60" in inside(*words, "--use", "temperature=60").stdout
    done = json.loads(inside(*words[:-1], 0.9, "--backtest", "--json").stdout)["signals"][0]["backtest"]
    assert done["end"] == pytest.approx(500)
    # At each cut it went on at 40 °C, as far as was known and as it did, so that its straight line holds.
    assert all(cut["remaining"]["median"] == pytest.approx(cut["left"], rel=0.1) for cut in done["cuts"][3:])
    for at, said in (
        ("heat=3", "'heat' is no condition that is known to speed wear up; expected temperature"),
        ("temperature", "--use temperature: expected a condition and a number, e.g. temperature=40"),
    ):
        told = inside(*words, "--use", at)
        assert told.returncode == 3
        assert said in " ".join(told.stderr.split())


@pytest.mark.full
def test_an_index_of_health_of_many_signals(inside, robot, tmp_path):
    """Signals of which two show wear in the last sixty hours; from ten units that failed."""
    rng = np.random.default_rng(1)

    def rows(life, until, name=""):
        t = np.arange(1.0, until)
        worn = np.maximum(0.0, 1 - (life - t) / 60) ** 1.5
        signals = (300 + 10 * worn, 5 - 2 * worn, 0 * t)
        noisy = [one + scale * rng.standard_normal(len(t)) for one, scale in zip(signals, (1, 0.3, 1), strict=True)]
        return [",".join([name, *(f"{x:.4f}" for x in row)][not name :]) for row in zip(t, *noisy, strict=True)]

    lives = rng.integers(80, 200, 10).tolist()
    failed = [row for k, life in enumerate(lives) for row in rows(life, life + 1, f"e{k}")]
    (tmp_path / "failed.csv").write_text("unit,time [h],heat,flow,humidity\n" + "\n".join(failed) + "\n")
    (tmp_path / "mine.csv").write_text("time [h],heat,flow,humidity\n" + "\n".join(rows(150, 126)) + "\n")
    words = ("wear", robot, "mine.csv", "--part", "battery", "--index")
    backtest = (*words, "--fleet", "failed.csv", "--backtest")
    done = inside(*backtest)
    assert done.returncode == 0, done.stderr
    assert "health index of 3 signals by 10 units that failed" in done.stdout
    units = json.loads(inside(*backtest, "--predictions", "p.csv", "--json").stdout)["signals"][0]["backtest_of_units"]
    assert {name: one["end"] for name, one in units.items()} == {f"e{k}": life for k, life in enumerate(lives)}
    cuts = [cut for one in units.values() for cut in one["cuts"]]
    for cut in cuts:  # what is left of a unit is compared with how long others went on
        assert cut["held"] == (cut["remaining"]["low"] <= cut["left"] <= cut["remaining"]["high"])
    assert np.mean([cut["held"] for cut in cuts]) > 0.7
    late = [one["cuts"][-1] for one in units.values()]  # a sixteenth of its life before its end damage shows
    assert np.median([abs(cut["remaining"]["median"] - cut["left"]) for cut in late]) < 10
    held = sum(cut["held"] for cut in cuts)
    assert f"{held} of {len(cuts)} intervals of 90 % held, of 10 lives" in done.stdout
    assert inside("calibrate", "p.csv").returncode in (0, 1)
    fails = re.search(r"Fails in \S+ h, 90 % between (\S+) and (\S+)", " ".join(done.stdout.split()))
    assert fails
    assert float(fails[1]) <= 25 <= float(fails[2])
    for more, code, said in (
        ((), 3, "from whom is an index of health learned? expected --fleet"),
        (
            ("--fleet", "failed.csv", "--settings", "heat,humidty"),
            3,
            "mine.csv: has no column 'humidty', expected one for each of --settings; did you mean 'humidity'?",
        ),
        (("--fleet", "failed.csv", "--threshold", 3), 2, "--threshold: not used for an index of health"),
    ):
        told = inside(*words, *more)
        assert told.returncode == code
        assert said in " ".join(told.stderr.split())
