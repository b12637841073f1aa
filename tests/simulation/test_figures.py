"""What stands in place of a rate, and parts of the library: the simulator takes them as the engine does."""

import math
import re

import numpy as np
import pytest
from scipy import stats
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.parts import part
from robophm.simulation.design_file import read_design

from .conftest import HEAD

LIVES = {
    "{}": stats.expon(),
    "{distribution: weibull, shape: 1.5}": stats.weibull_min(1.5),
    "{distribution: lognormal, log_deviation: 0.7}": stats.lognorm(0.7),
    "{distribution: gamma, shape: 3}": stats.gamma(3),
}


@pytest.mark.parametrize("life", LIVES)
@pytest.mark.parametrize("key", ["mtbf", "mttf", "l10", "b10"])
def test_a_mean_or_a_tenth_gives_the_rate(design, key, life):
    """By another program: of each life the mean, and the age by which a tenth have failed, of one scale."""
    (mode,) = design(f"components: {{A: {{{key}: 700 h, life: {life}}}}}").modes
    peer = LIVES[life]
    assert 1 / mode.rate == pytest.approx(700 * (1.0 if key in ("mtbf", "mttf") else peer.mean() / peer.ppf(0.1)))
    if key in ("l10", "b10"):
        assert mode.life.log_survival(np.asarray(700.0), np.asarray(1 / mode.rate)) == pytest.approx(math.log(0.9))


def test_a_tenth_of_a_normal_life(design):
    (mode,) = design("components: {A: {l10: 700 h, life: {distribution: normal, deviation: 50 h}}}").modes
    assert 1 / mode.rate == pytest.approx(700 - stats.norm.ppf(0.1) * 50)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{rate: 1 FIT, mtbf: 3 h}", "has rate and mtbf; what has not one rate"),
        ("{mtbf: 3 km}", "mtbf: unit 'km' does not measure what 'h' does"),
        ("{part: no_such_lidar_at_all}", "part: no part 'no_such_lidar_at_all' in the library"),
    ],
)
def test_what_is_wrong_is_said(design, text, said):
    with pytest.raises(DesignError, match=re.escape(said)):
        design(f"components: {{A: {text}}}")


def test_a_part_of_the_library_is_simulated_as_the_engine_reads_it(design):
    """The two read designs by themselves, and must agree of what the library says."""
    text = "components: {A: {part: lidar_2d, quantity: 2}}"
    modes = design(text).modes
    (theirs,) = parse(f"schema_version: 1\nname: R\n{text}").modes
    assert [mode.rate for mode in modes] == pytest.approx([theirs.rate] * 2, rel=1e-12)
    assert modes[0].uncertainty == ("error_factor", (theirs.uncertainty.error_factor,))
    assert part("lidar_2d").grade in theirs.source


def test_without_a_library_its_parts_are_refused(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(f"{HEAD}components:\n  A: {{part: lidar_2d}}\n")
    with pytest.raises(DesignError, match=r"robot.yaml:6: components/A/part: is of a library, and none is given"):
        read_design(path)


def test_a_fleet_of_a_robot_with_a_part_of_the_library(tmp_path):
    """From the command line, which gives the simulator the library."""
    design = tmp_path / "robot.yaml"
    design.write_text(f"{HEAD}components:\n  A: {{part: lidar_2d}}\ntask: {{duration: 10 min}}\n")
    words = ["--to", str(tmp_path / "fleet"), "--robots", "3", "--tasks", "2", "--seed", "1"]
    assert CliRunner().invoke(app, ["simulate", str(design), *words], catch_exceptions=False).exit_code == 0
    assert (tmp_path / "fleet" / "robot.yaml").read_text() == design.read_text()
