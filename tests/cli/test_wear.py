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
    assert said["trend"]["low"] < -1e-4 < said["trend"]["high"]
    left = (1 - 1e-4 * 1495 - 0.7) / 1e-4
    assert said["remaining"]["low"] < left < said["remaining"]["high"]
    assert 500 <= said["change"]["alarms"][0] <= 1200  # the baseline ends at 495 h
    lives = said["remaining_life"]
    assert lives["battery"]["fused"]["median"] == pytest.approx(2 * said["remaining"]["median"], rel=0.02)
    assert lives["courier"]["fused"]["median"] < lives["battery"]["fused"]["median"]


def test_dates_ambient_and_load(inside, robot, tmp_path):
    """A bearing that runs ever hotter above the air; a current at half load."""
    rng = np.random.default_rng(2)
    rows = ["when,value,ambient"]
    for i in range(120):
        air = rng.uniform(10, 30)
        rows.append(
            f"2024-{1 + i // 28:02}-{1 + i % 28:02},{air + 20 + 0.1 * i + 0.2 * rng.standard_normal():.3f},{air:.3f}"
        )
    (tmp_path / "bearing.csv").write_text("\n".join(rows) + "\n")
    words = ("wear", robot, "bearing.csv", "--part", "battery", "--threshold", 40, "--baseline", 30, "--json")
    said = json.loads(inside(*words).stdout)
    assert said["unit"] == "h"
    assert said["remaining"]["low"] < (40 - 20 - 11.9) / 0.1 * 24 < said["remaining"]["high"]
    load = rng.uniform(0, 1, 120)
    lines = [f"{i},{2 + 3 * x + 0.01 * i + 0.02 * rng.standard_normal():.4f},{x:.4f}" for i, x in enumerate(load)]
    (tmp_path / "current.csv").write_text("time [h],value,load\n" + "\n".join(lines) + "\n")
    words = (
        "wear",
        robot,
        "current.csv",
        "--part",
        "computer",
        "--threshold",
        6,
        "--baseline",
        40,
        "--load",
        0.5,
        "--json",
    )
    said = json.loads(inside(*words).stdout)
    assert said["trend"]["low"] < 0.01 < said["trend"]["high"]
    assert said["noise"] < 0.1  # what the load did is not taken for noise


def test_mistakes_are_one_line(inside, robot, tmp_path):
    (tmp_path / "km.csv").write_text("time [km],value\n" + "".join(f"{i},{i}\n" for i in range(9)))
    (tmp_path / "back.csv").write_text("time [h],value\n5,1\n3,2\n")
    (tmp_path / "load.csv").write_text("time [h],value,load\n" + "".join(f"{i},{i},1\n" for i in range(200)))
    words = ("--part", "battery", "--threshold", 0.7)
    for some, said in (
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
