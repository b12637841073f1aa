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
    (unbiased,) = (line for line in text.splitlines() if "unbiased" in line)
    assert "310.2 (158 … 549)" in unbiased  # NIST's (apr452)
    said = json.loads(inside("fit", "lift.csv", "--repairable", "--level", "0.8", "--json").stdout)
    assert said["estimate"] == "unbiased"
    assert list(said["estimates"]) == ["unbiased", "maximum likelihood"]
    assert said["estimates"]["unbiased"]["beta"]["value"] == said["beta"]["value"] == pytest.approx(0.483506, rel=1e-5)
    (tmp_path / "two.csv").write_text("item,time [h],censored\na,5,\na,40,\na,90,yes\nb,20,\nb,30,\nb,60,yes\n")
    assert "of these there is no unbiased estimate" in inside("fit", "two.csv", "--repairable").stdout


@pytest.mark.parametrize(
    ("words", "unused"),
    [
        (("lives.csv", "--seed", 1), "--seed"),
        (("lives.csv", "--use", "temperature=40 degC", "--by", "ranks", "--refits", 5), "--by, --refits"),
        (("hot.csv", "--by", "likelihood"), "--by"),  # as stated as its default, but not used
        (("lives.csv", "--repairable", "--by", "ranks", "--distribution", "normal", "--refits", 5, "--seed", 2,
          "--use", "temperature=40 degC", "--law", "temperature=q10", "--report", "x.html", "--to", "robot.yaml",
          "--part", "pump"),
         "--distribution, --by, --use, --law, --refits, --seed, --report, --to, --part"),
    ],
)  # fmt: skip
def test_an_option_that_is_not_used_is_refused(inside, lives, tmp_path, words, unused):
    (tmp_path / "hot.csv").write_text("time [h],temperature [degC]\n5,80\n6,90\n")
    refused = inside("fit", *words)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert f"Error: {unused}: not used for " in refused.stderr
    assert not (tmp_path / "x.html").exists()


def test_mistakes_are_one_line(inside, lives, tmp_path):
    (tmp_path / "grit.csv").write_text("time [h],grit\n5,1\n6,1\n3,2\n2,2\n1,3\n")
    for name, times in (("word", "five\n6\n7\n"), ("wide", "1e-300\n2\n1e300\n")):
        (tmp_path / f"{name}.csv").write_text(f"time [h]\n{times}")
    (tmp_path / "typo.csv").write_text("time [h],temprature\n5,80\n6,90\n")
    (tmp_path / "event.csv").write_text("time [h],event\n5,failure\n6,censored\n")
    (tmp_path / "since.csv").write_text("time [h],since\n5,1\n6,2\n")
    (tmp_path / "hot.csv").write_text("item,time [h],temperature [degC],censored\na,5,80,\na,6,90,yes\n")
    (tmp_path / "counts.csv").write_text("item,time [h],count,censored\na,5,2,\na,6,1,yes\n")
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
        (("typo.csv",), "column 'temprature' is not known; did you mean 'temperature'?"),
        (("event.csv",), "column 'event' is no stress; expected 'censored', with yes for what still worked"),
        (("since.csv",), "column 'since' is no stress; expected lives watched from 0 on; `robophm learn` takes others"),
        (("hot.csv", "--repairable"), "repaired systems are taken at one stress; it has temperature"),
        (("counts.csv", "--repairable"), "each failure of a repaired system is a row; expected no count but 1"),
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
    from robophm.learning.life_data.surpyval import library

    with pytest.raises(RobophmError, match=r"fitting needs SurPyval \(surpyval\). Install robophm\[fit\]"):
        library()


def test_surpyval_is_loaded_by_nothing_else(command, run):
    import subprocess

    code = "import robophm.cli.fit, robophm.learning.life_data.life_stress, sys; print('surpyval' in sys.modules)"
    found = subprocess.run([command[0], "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "False"
