"""robophm learn and robophm service, run as a newcomer does."""

import json
import re
import shutil

import pytest

from robophm.core.signal import SECOND
from robophm.design.file import load
from robophm.learning.rates.gamma_poisson import update
from robophm.transports.synthetic import SyntheticOta

ROBOT = """
schema_version: 1
name: courier
components:
  motor: {quantity: 2, rate: 8 FPMH}  # maker
  lidar: {rate: 300 FIT}
"""
LOG = "part,robot,exposure [h],censored\nmotor,r1,4000,\nmotor,r1,9000,yes\nlidar,r1,9000,yes\nlidar,r2,100,\n"


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(ROBOT)
    (tmp_path / "log.csv").write_text(LOG)
    return path


def test_learned_and_written(inside, robot, tmp_path):
    text = inside("learn", robot, "log.csv", "--to", "new.yaml")
    assert text.returncode == 0
    assert "What the field says of courier, 2 robots" in text.stdout
    assert "lidar: 1 failure contradicts" in text.stdout.replace("* ", "")
    assert (tmp_path / "new.yaml").read_text().count("# maker") == 1
    said = json.loads(inside("learn", robot, "log.csv", "--json").stdout)["rates"]
    (motor,) = (one for one in said if one["mode"] == "motor")
    assert motor["expected"] == pytest.approx(13000 * 8e-6)
    assert motor["learned_rate"] == pytest.approx(8e-6 * update(1, 0.104, 1.0).estimate)
    assert load(tmp_path / "new.yaml").modes[0].rate == pytest.approx(motor["learned_rate"], rel=1e-5)
    again = json.loads(inside("learn", "new.yaml", "log.csv", "--json").stdout)["rates"]
    assert again[0]["factor"] == pytest.approx(motor["factor"], rel=1e-5)


def test_a_fleet_whose_robots_differ(inside, robot, tmp_path):
    """The next robot, their mean, each robot: three rates with their intervals, in every face."""
    rows = [f"motor,r{i},20000,{no}\n" for i in (0, 1, 2, 3, 5) for no in ("", "", "yes")]
    rows += ["motor,r4,500,\n"] * 30
    (tmp_path / "fleet.csv").write_text("part,robot,exposure [h],censored\n" + "".join(rows))
    text = inside("learn", robot, "fleet.csv", "--to", "new.yaml").stdout
    assert "90 % of the next robot" in text
    assert re.search(r"motor: robots differ by \d+ % \(\d+ … \d+ %\); their mean is .* /h with 90 %", text)
    assert re.search(r'note: ".*robots differ by', (tmp_path / "new.yaml").read_text())
    (said,) = json.loads(inside("learn", robot, "fleet.csv", "--json").stdout)["rates"]
    assert said["robots"]["r4"]["failures"] == 30
    assert said["spread_of_robots"]["low"] > 0.1
    assert (said["low"], said["high"]) == (said["next_robot"]["low"], said["next_robot"]["high"])
    assert (
        said["next_robot"]["low"] < said["fleet_mean"]["low"] < said["fleet_mean"]["high"] < said["next_robot"]["high"]
    )
    (own,) = json.loads(inside("learn", robot, "fleet.csv", "--robot", "r4", "--json").stdout)["rates"]
    assert own["factor"] == said["robots"]["r4"]["factor"]
    assert "90 % of r4" in inside("learn", robot, "fleet.csv", "--robot", "r4").stdout


def test_nothing_is_lost_by_a_mistake(inside, robot, tmp_path):
    before = robot.read_bytes()
    for words, said in (
        ((robot, "log.csv", "--to", robot), "exists; expected a new name, or --force"),
        ((robot, "nolog.csv"), "no such file"),
        ((robot, "log.csv", "--prior", "5 bananas"), "prior '5 bananas': unknown unit 'bananas'"),
        ((robot, "log.csv", "--robot", "r9"), "no robot 'r9' in what was seen; there are r1, r2"),
    ):
        failed = inside("learn", *words)
        assert (failed.returncode, failed.stdout) == (3, "")
        assert said in failed.stderr
        assert failed.stderr.count("\n") == 1
    assert robot.read_bytes() == before
    assert inside("learn", robot, "log.csv", "--to", robot, "--force").returncode == 0
    assert "learned" in robot.read_text()


def test_a_robots_own_ledger(inside, design, tmp_path):
    SyntheticOta(seed=3, duration=600 * SECOND).record(tmp_path / "day.mcap")
    inside("replay", design, "day.mcap", "--store", "past.db")
    robot = load(design)
    part = next(one.path for one in robot.all_components() if one.quantity == 1 and len(one.modes) == 1)
    looked = inside("service", design, part, "--store", "past.db", "--history")
    assert "was neither replaced nor repaired so far" in looked.stdout
    done = inside("service", design, part, "--store", "past.db", "--replaced", "--failed")
    assert done.returncode == 0
    assert f"{part} replaced after it failed, at an effective age of" in done.stdout
    half = inside("service", design, part, "--store", "past.db", "--repaired", "0.5", "--history", "--json")
    assert [one["kind"] for one in json.loads(half.stdout)["services"]] == ["replaced", "repaired"]
    found = json.loads(inside("learn", design, "past.db", "--json").stdout)["rates"]
    assert {one["mode"]: one["failures"] for one in found}[part] == 1
    assert all((one["factor"] - 1) * (one["failures"] - one["expected"]) >= 0 for one in found)
    for folder in ("r1", "r2"):  # as many robots have it: each its own, of one name
        (tmp_path / folder).mkdir()
        shutil.copy(tmp_path / "past.db", tmp_path / folder)
    of_two = json.loads(inside("learn", design, "r1/past.db", "r2/past.db", "--json").stdout)["rates"]
    assert {name: own["failures"] for one in of_two if one["mode"] == part for name, own in one["robots"].items()} == {
        "r1/past": 1, "r2/past": 1,
    }  # fmt: skip
    twice = inside("learn", design, "past.db", tmp_path / "past.db")
    assert (twice.returncode, twice.stdout) == (3, "")
    assert "past.db: is given twice, and would count twice; expected each log once" in twice.stderr
    for words, said in (((), "or has it failed?"), (("--by", "Ada", "--history"), "--by and --note are of"),
                        (("--replaced", "--repaired", 0.5), "was it replaced or repaired")):  # fmt: skip
        assert said in inside("service", design, part, "--store", "past.db", *words).stderr
    wrong = inside("service", design, "wheels", "--store", "past.db", "--replaced")
    assert wrong.returncode == 3
    assert "no part 'wheels'" in wrong.stderr
    assert "no such store" in inside("service", design, part, "--store", "none.db", "--replaced").stderr
