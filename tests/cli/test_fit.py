"""robophm fit, run as a newcomer does."""

import json
import re
import sys

import numpy as np
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
    (tmp_path / "ended.csv").write_text("item,time [h]\n" + "".join(f"a,{t}\n" for t in times))
    ended = inside("fit", "ended.csv", "--repairable").stdout
    assert "Taken as watched until the last failure" in ended
    assert json.loads(inside("fit", "ended.csv", "--repairable", "--json").stdout)["ended_with_failure"] is True


@pytest.mark.parametrize(
    ("words", "unused"),
    [
        (("lives.csv", "--seed", 1), "--seed"),
        (("lives.csv", "--use", "temperature=40 degC", "--by", "ranks", "--refits", 5), "--by, --refits"),
        (("lives.csv", "--some-never-fail", "--by", "ranks", "--report", "x.html"), "--by, --report"),
        (("modes.csv", "--by", "ranks", "--refits", 5), "--by, --refits"),
        (("hot.csv", "--by", "likelihood"), "--by"),  # as stated as its default, but not used
        (("lives.csv", "--repairable", "--by", "ranks", "--distribution", "normal", "--refits", 5, "--seed", 2,
          "--use", "temperature=40 degC", "--law", "temperature=q10", "--report", "x.html", "--to", "robot.yaml",
          "--part", "pump"),
         "--distribution, --by, --use, --law, --refits, --seed, --report, --to, --part"),
    ],
)  # fmt: skip
def test_an_option_that_is_not_used_is_refused(inside, lives, tmp_path, words, unused):
    (tmp_path / "hot.csv").write_text("time [h],temperature [degC]\n5,80\n6,90\n")
    (tmp_path / "modes.csv").write_text("time [h],mode\n5,a\n6,a\n7,b\n")
    refused = inside("fit", *words)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert f"Error: {unused}: not used for " in refused.stderr
    assert not (tmp_path / "x.html").exists()


def test_failure_modes_in_every_face(inside, lives, tmp_path):
    (tmp_path / "modes.csv").write_text(
        "time [h],mode,censored\n10,wear,\n20,wear,\n33,surge,\n35,surge,\n28,wear,\n40,,yes\n"
    )
    (tmp_path / "arm.yaml").write_text(
        "schema_version: 1\nname: R\ncomponents:\n  arm:\n    failure_modes:\n"
        "      wear: {rate: 5 FPMH}  # guess\n      surge: {rate: 1 FPMH}\n"
    )
    done = inside("fit", "modes.csv", "--report", "modes.html", "--to", "arm.yaml", "--part", "arm")
    assert done.returncode == 0
    assert re.search(r"wear +3 .*\nsurge +2 ", done.stdout) or re.search(r"surge +2 .*\n.*wear +3 ", done.stdout)
    assert "all together" in done.stdout
    assert "the failure modes of arm have these lives now" in done.stdout
    assert "# guess" in (tmp_path / "arm.yaml").read_text()
    page = (tmp_path / "modes.html").read_text()
    assert "all together" in page
    assert page.count("<circle") == 5
    said = json.loads(inside("fit", "modes.csv", "--json").stdout)
    assert sum(one["first_in"] for one in said["modes"].values()) == pytest.approx(1, abs=1e-3)
    assert said["mean"] < min(one["mean"] for one in said["modes"].values())


def test_no_figure_from_far_outside_the_data(inside, tmp_path):
    (tmp_path / "few.csv").write_text("time [h],censored,count\n0.1,,3\n3,,1\n20,,1\n90,,1\n1000,yes,5000\n")
    done = inside("fit", "few.csv", "--distribution", "weibull", "--report", "few.html")
    assert "beyond 100,000" in done.stdout
    assert "of which these data tell nothing; --some-never-fail says" in done.stdout.replace("\n", " ")
    assert "Not for a design" in done.stdout
    table = (tmp_path / "few.html").read_text()
    for text in (done.stdout.partition("probability plot")[0], table.partition("<svg")[0]):
        assert not re.search(r"\de\d\d", text)  # no 1.2e34
    said = json.loads(inside("fit", "few.csv", "--distribution", "weibull", "--json").stdout)["fits"][0]
    assert said["mean"] is None
    assert said["known_until"] == 100_000
    assert said["quantiles"]["0.5"]["value"] is None
    some = inside("fit", "few.csv", "--some-never-fail")
    assert re.search(r"share that ever fails \[%\] +0.1", some.stdout)
    assert "never so many" in some.stdout
    share = json.loads(inside("fit", "few.csv", "--some-never-fail", "--json").stdout)
    assert share["share_that_fails"]["low"] < 0.0012 < share["share_that_fails"]["high"]


def test_mistakes_are_one_line(inside, lives, tmp_path):
    (tmp_path / "grit.csv").write_text("time [h],grit\n5,1\n6,1\n3,2\n2,2\n1,3\n")
    for name, times in (("word", "five\n6\n7\n"), ("wide", "1e-300\n2\n1e300\n")):
        (tmp_path / f"{name}.csv").write_text(f"time [h]\n{times}")
    (tmp_path / "typo.csv").write_text("time [h],temprature\n5,80\n6,90\n")
    (tmp_path / "event.csv").write_text("time [h],event\n5,failure\n6,gone\n")
    (tmp_path / "since.csv").write_text("time [h],since [h]\n5,1\n6,9\n")
    (tmp_path / "hot.csv").write_text("item,time [h],temperature [degC],censored\na,5,80,\na,6,90,yes\n")
    (tmp_path / "counts.csv").write_text("item,time [h],count,censored\na,5,2,\na,6,1,yes\n")
    (tmp_path / "km.csv").write_text("time [km]\n5\n6\n7\n")
    (tmp_path / "few.csv").write_text("item,time [h],censored\na,5,\na,9,yes\n")
    for words, said in (
        (("word.csv",), "word.csv:2: time: 'five' is no time; expected a number with its unit"),
        (("wide.csv",), "wide.csv:2: time: 1e-300 is no life; expected 1e-15 … 1e+15 h"),
        (("few.csv", "--repairable"), "few.csv: 1 failure of repaired systems"),
        (("km.csv", "--to", "robot.yaml", "--part", "pump"), "ages by h (operating clock), but km.csv counts km"),
        ((lives, "--distribution", "weibul"), "no distribution 'weibul'; did you mean 'weibull'"),
        ((lives, "--to", "robot.yaml"), "expected both"),
        ((lives, "--to", "robot.yaml", "--part", "pmp"), "no part 'pmp'; did you mean 'pump'"),
        ((lives, "--use", "temperature=40 degC"), "states no stress"),
        (("grit.csv",), "at which grit will parts be used? expected --use STRESS=VALUE, or no such column"),
        (("typo.csv",), "column 'temprature' is not known; did you mean 'temperature'?"),
        (("event.csv",), "event.csv:3: event: 'gone'; expected failed or worked or left"),
        (("since.csv",), "since.csv:3: since: 9 is not before the part was last seen"),
        (("since.csv", "--use", "since=3"), "since.csv:3: since: 9 is not before the part was last seen"),
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


def test_few_parts_have_no_corrected_aic_and_far_stresses_rest_on_the_law(inside, tmp_path):
    (tmp_path / "few.csv").write_text("time [h]\n100\n200\n400\n")
    said = inside("fit", "few.csv").stdout
    assert "∞" not in said
    assert "3 parts are too few to correct AIC for them: ranked without" in said
    fits = {one["distribution"]: one for one in json.loads(inside("fit", "few.csv", "--json").stdout)["fits"]}
    assert fits["weibull"]["aic_corrected"] is None
    rows = "".join(f"{time * 10**k},{t}\n" for k, t in enumerate((80, 60, 40)) for time in (80, 100, 120))
    (tmp_path / "hot.csv").write_text(f"time [h],temperature [degC]\n{rows}")
    far, near = (
        inside("fit", "hot.csv", "--distribution", "lognormal", "--use", f"temperature={use} degC").stdout
        for use in (-100, 35)
    )
    # Ten times as long for each step of 20 degrees: Arrhenius by the three means, by least squares.
    inverse = [1 / (8.617333e-5 * (one + 273.15)) for one in (80, 60, 40, -100)]
    slope = np.polyfit(inverse[:3], [0, np.log(10), np.log(100)], 1)[0]
    factor = float(re.search(r"even the nearest test aged parts (\S+) times as fast as use", far).group(1))
    assert np.log(factor) == pytest.approx(slope * (inverse[3] - inverse[2]), rel=1e-3)
    assert "rest on the law alone" not in near.replace("\n", " ")
