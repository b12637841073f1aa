"""robophm fit, run as a newcomer does."""

import json
import re
import sys

import pytest

from robophm.design.file import load

pytest.importorskip("surpyval")

NIST = "time [h],censored,count\n54\n187\n216\n240\n244\n335\n361\n373\n375\n386\n500,yes,10\n"
ROBOT = "schema_version: 1\nname: R\ncomponents:\n  # the pump\n  pump: {rate: 5 FPMH}\n"


@pytest.fixture
def lives(tmp_path):
    (tmp_path / "robot.yaml").write_text(ROBOT)
    path = tmp_path / "lives.csv"
    path.write_text(NIST)
    return path


def test_lives_as_table_plot_page_and_design(inside, lives, tmp_path):
    done = inside("fit", lives, "--distribution", "weibull", "--report", "fit.html")
    assert done.returncode == 0
    assert "10 failures and 10 that still worked" in done.stdout
    assert re.search(r"scale 606.5 \(432 … 851\), shape 1.721 \(1.06 … 2.78\)", done.stdout)
    assert done.stdout.count("o") > 10
    assert "life: {distribution: weibull, shape: 1.7208}" in done.stdout
    page = (tmp_path / "fit.html").read_text()
    assert page.count("<circle") == 10
    put = inside("fit", lives, "--distribution", "weibull", "--to", "robot.yaml", "--part", "pump", "--json")
    said = json.loads(put.stdout)
    assert said["fits"][0]["parameters"]["shape"]["value"] == pytest.approx(1.7208, rel=1e-4)
    (mode,) = load(tmp_path / "robot.yaml").modes
    assert mode.life.scale == pytest.approx(606.528, rel=1e-4)
    assert "# the pump" in (tmp_path / "robot.yaml").read_text()
    assert (tmp_path / "robot.yaml.bak").read_text() == ROBOT


def test_stress_and_repairs(inside, tmp_path):
    (tmp_path / "hot.csv").write_text(
        "time [h],temperature [degC]\n" + "".join(f"{t},85\n" for t in (900, 1100, 1300, 1600)) +
        "".join(f"{t},125\n" for t in (90, 110, 150, 170))
    )  # fmt: skip
    text = inside("fit", "hot.csv", "--use", "temperature=40 degC").stdout
    assert "temperature: arrhenius" in text
    assert "acceleration: {model: arrhenius, activation_energy: 0.6" in text
    assert inside("fit", "hot.csv", "--use", "temperature=40 degC", "--report", "hot.html").returncode == 0
    assert (
        json.loads(inside("fit", "hot.csv", "--use", "temperature=40 degC", "--json").stdout)["levels"][0]["parts"] == 4
    )
    times = [5, 40, 43, 175, 389, 712, 747, 795, 1299, 1478]
    (tmp_path / "lift.csv").write_text(
        "item,time [h],censored\n" + "".join(f"a,{t},\n" for t in times) + "a,1500,yes\n"
    )
    text = inside("fit", "lift.csv", "--repairable", "--level", "0.8").stdout
    assert "10 failures of 1 repaired system: they improve" in text
    assert "310.2 (158 … 549) h between failures" in text


def test_mistakes_are_one_line(inside, lives, tmp_path):
    (tmp_path / "grit.csv").write_text("time [h],grit\n5,1\n6,1\n3,2\n2,2\n1,3\n")
    for name, times in (("word", "five\n6\n7\n"), ("wide", "1e-300\n2\n1e300\n")):
        (tmp_path / f"{name}.csv").write_text(f"time [h]\n{times}")
    (tmp_path / "km.csv").write_text("time [km]\n5\n6\n7\n")
    (tmp_path / "few.csv").write_text("item,time [h],censored\na,5,\na,9,yes\n")
    for words, said in (
        (("word.csv",), "word.csv:2: time: 'five' is no time; expected a number with its unit"),
        (("wide.csv",), "wide.csv:2: time: 1e-300 is no life; expected 1e-15 … 1e+15 h"),
        (("few.csv", "--repairable"), "few.csv: 1 failures of repaired systems"),
        (("km.csv", "--to", "robot.yaml", "--part", "pump"), "ages by h (operating clock), but km.csv counts km"),
        ((lives, "--distribution", "weibul"), "no distribution 'weibul'; did you mean 'weibull'"),
        ((lives, "--to", "robot.yaml"), "expected both"),
        ((lives, "--to", "robot.yaml", "--part", "pmp"), "no part 'pmp'; did you mean 'pump'"),
        ((lives, "--use", "temperature=40 degC"), "states no stress"),
        (("grit.csv",), "at which grit will parts be used? expected --use 'grit=…'"),
        (("grit.csv", "--use", "grit"), "--use 'grit'; expected e.g. temperature="),
    ):
        failed = inside("fit", *words)
        assert (failed.returncode, failed.stdout) == (3, "")
        assert said in failed.stderr
        assert failed.stderr.count("\n") == 1
    assert (tmp_path / "robot.yaml").read_text() == ROBOT


def test_without_surpyval(inside, lives, monkeypatch):
    for name in [name for name in sys.modules if name.partition(".")[0] == "surpyval"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "surpyval", None)
    from robophm.core.errors import RobophmError
    from robophm.learning.surpyval import library

    with pytest.raises(RobophmError, match=r"fitting needs SurPyval \(surpyval\). Install robophm\[fit\]"):
        library()


def test_surpyval_is_loaded_by_nothing_else(command, run):
    import subprocess

    code = "import robophm.cli.fit, robophm.learning.life_stress, sys; print('surpyval' in sys.modules)"
    found = subprocess.run([command[0], "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "False"
