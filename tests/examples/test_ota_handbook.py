"""The paper's robot by the handbooks: its rates by hand, its sensors, and the page that sets it beside the paper."""

import io
import math
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from robophm.cli import main
from robophm.core.signal import SECOND, Sample
from robophm.design.file import load
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant

ROOT = Path(__file__).parents[2]
OTA = ROOT / "examples" / "ota"
FIRST_PAGE = OTA / "README.md"
PAGE = ROOT / "docs" / "guides" / "paper-and-handbook.md"
BOARD, DRIVER, IPS = "Power/Battery Control Board/", "Power/Low Level Control Unit DSK-MD/", "Sensing/IPS/"
DSK_M = "Communication/DSK-M/"
KEPT = {
    IPS + "Antenna", "Communication/Antenna", "Sensing/SICK Laser Sensor", "Sensing/Camera", "Mobility/Driver wheel",
    "Mobility/Caster wheel", "Computation/YSK-M", "Computation/YSK-G",
}  # fmt: skip
"""No handbook has a model of them."""


def arrhenius(energy, celsius, reference=25):
    """The handbook's: k = 8.617e-5 eV/K, 25 °C = 298 K."""
    return math.exp(energy / 8.617e-5 * (1 / (reference + 273) - 1 / (celsius + 273)))


def semiconductor(constant, celsius):
    return math.exp(constant * (1 / 298 - 1 / (celsius + 273)))


def connector(base, amperes, rise, matings):
    return base * arrhenius(0.14, 25 + rise * amperes**1.85) * matings * 2 * 8


def circuit(die, energy, junction, pins):
    """§5.1: commercial quality 10, GM 4, surface mount in plastic, years in production 1."""
    return (die * 0.1 * arrhenius(energy, junction) + 3.6e-4 * pins**1.08 * 4) * 10


# MIL-HDBK-217F Notice 2 and NSWC-11 by hand, failures/10⁶ h, in GM and of commercial quality.
FILM = 0.0037 * 0.01**0.39 * 0.71 * math.exp(1.1 * 0.1) * 10 * 16
LOGIC = 0.00099 * 0.1**0.09 * ((3.3 / 16 / 0.6) ** 3 + 1) * 10 * 20
USB = connector(0.046, 0.5, 2.286, 2)
MICROCONTROLLER = circuit(0.56, 0.35, 35 + 10 * 0.3, 100)
BY_HAND = {
    BOARD + "Capacitor": 0.00099 * 0.1**0.09 * ((24 / 50 / 0.6) ** 3 + 1) * 10 * 20,
    BOARD + "Thermistor": 0.0019 * 0.001**0.39 * 10 * 16,
    BOARD + "Diode": 0.0030 * semiconductor(3091, 45) * 0.6**2.43 * 8 * 9,
    BOARD + "LED": 0.00023 * semiconductor(2790, 35) * 8 * 8,
    BOARD + "Resistor": FILM,
    BOARD + "Trimpot": 0.0037 * 0.01**0.39 * 0.71 * math.exp(1.1 * 0.02) * 10 * 16,
    BOARD + "Step Down Switching Regulator": circuit(0.020, 0.65, 55 + 2 * 1.5, 5),
    BOARD + "Terminal Block or Connector": connector(0.046, 3, 0.640, 1),
    BOARD + "Connector or Socket": 0.00064 * math.exp(3.9**0.39) * 14,
    BOARD + "Inductor": 0.000030 * arrhenius(0.11, 25 + 1.1 * 40) * 3 * 12,
    BOARD + "Current Sensor": circuit(0.040, 0.35, 35 + 20 * 0.003, 16),
    BOARD + "Female Header": connector(0.046, 0.5, 2.286, 1),
    DRIVER + "XT60 Socket": connector(0.0070, 20, 0.100, 2),
    DRIVER + "Zener Diode": 0.0020 * semiconductor(1925, 35) * 8 * 9,
    DRIVER + "Ultrafast Diode": 0.025 * semiconductor(3091, 45) * 0.054 * 8 * 9,
    DRIVER + "Aluminum Capacitor": 0.00012 * 470**0.23 * ((24 / 50 / 0.6) ** 5 + 1) * 10 * 20,
    DRIVER + "Micro USB Connector": USB,
    DRIVER + "16MHz Cryst. Osc.": 0.013 * 16**0.23 * 2.1 * 10,
    DRIVER + "32.768kHz Cryst. Osc.": 0.013 * 0.032768**0.23 * 2.1 * 10,
    DRIVER + "Resistors": FILM,
    DRIVER + "STM32F407VGT6": MICROCONTROLLER,
    DRIVER + "Resettable Fuse": 0.0019 * 0.5**0.39 * 10 * 16,
    "Power/Battery": 0.150,
    IPS + "Micro USB Connector": USB,
    IPS + "DW1000 Chip": circuit(0.29, 0.35, 35 + 20 * 0.3, 48),
    IPS + "Resistor": FILM,
    IPS + "Capacitor": LOGIC,
    DSK_M + "Resistor": FILM,
    DSK_M + "Capacitor": LOGIC,
    DSK_M + "25MHz Crystal Oscillator": 0.013 * 25**0.23 * 2.1 * 10,
    DSK_M + "16MHz Crystal Oscillator": 0.013 * 16**0.23 * 2.1 * 10,
    DSK_M + "STM32F407VGT6": MICROCONTROLLER,
    DSK_M + "SN65HVD230DR": circuit(0.020, 0.65, 35 + 20 * 0.1, 8),
    DSK_M + "Fuse": 0.010 * 8,
    DSK_M + "LAN8720A-CP": circuit(0.16, 0.35, 35 + 20 * 0.2, 24),
    DSK_M + "Micro USB Connector": USB,
    "Mobility/Encoder": 2.5,
    "Mobility/DC Motor": 2.17 * 2 + 40 * 2 ** ((25 - 40) / 10) + 2 * 3.2 + 0.001,
    "Mobility/Bearing": 60 * 30 * 0.03**3 * 0.223 / math.log(2) ** (2 / 3) * 1.5 * 1.8,
}


@pytest.fixture(scope="module")
def paper():
    return load(OTA / "robot.yaml")


@pytest.fixture(scope="module")
def handbook():
    return load(OTA / "handbook.yaml")


@pytest.fixture(scope="module")
def page():
    return PAGE.read_text(encoding="utf-8")


def pieces(robot):
    return {part.path: part for part in robot.all_components()}


def rate(part):
    return part.modes[0].rate


def wiring(robot):
    return {"": repr(robot.diagram)} | {module.path: repr(module.diagram) for module in robot.all_modules()}


def test_it_is_the_same_robot(paper, handbook):
    assert handbook.warnings == ()
    ours = {path: (part.quantity, part.required) for path, part in pieces(handbook).items()}
    assert ours == {path: (part.quantity, part.required) for path, part in pieces(paper).items()}
    assert wiring(handbook) == wiring(paper)
    assert handbook.functions == paper.functions
    assert (handbook.task, handbook.usage, handbook.thresholds) == (paper.task, paper.usage, paper.thresholds)


def test_every_rate_by_hand(paper, handbook):
    given, ours = pieces(paper), pieces(handbook)
    assert set(ours) == set(BY_HAND) | KEPT
    for path, by_hand in BY_HAND.items():
        assert rate(ours[path]) == pytest.approx(by_hand * 1e-6, rel=1e-9), path
    for path in KEPT:
        assert rate(ours[path]) == rate(given[path])
        assert "Table 17" in ours[path].modes[0].source


def test_a_new_robot_by_hand(handbook):
    """All is in series but the camera and the laser, which are one of two."""
    parts = pieces(handbook)
    pair = ("Sensing/SICK Laser Sensor", "Sensing/Camera")
    total = math.fsum(BY_HAND[path] * 1e-6 * parts[path].quantity for path in BY_HAND)
    total += math.fsum(rate(parts[path]) * parts[path].quantity for path in KEPT if path not in pair)
    new = as_designed(Plant(handbook))
    assert new.hazard_rate(handbook.diagram) == pytest.approx(total, rel=1e-9)
    both = math.prod(-math.expm1(-rate(parts[path]) * 1000) for path in pair)
    state = new.survival_curve(handbook.diagram, np.array([1000.0]))
    assert state.works[0] == pytest.approx(math.exp(-total * 1000) * (1 - both), rel=1e-9)


def lived(robot, celsius):
    """How much faster each part ages than by the clock, all five sensors reading the same for ten minutes."""
    ledger = Ledger.new(robot)
    ledger.started = 0
    topics = [f"/ota/{name}/temperature.temperature"
              for name in ("power", "sensing", "communication", "mobility", "computation")]  # fmt: skip
    samples = [Sample(second * SECOND, topic, celsius) for second in range(600) for topic in topics]
    ExposureIntegrator(robot).integrate(ledger, samples, 600 * SECOND)
    factors = ledger.effective.value / ledger.age.value
    return {mode.path: float(factor) for mode, factor in zip(robot.modes, factors, strict=True)}


def test_at_the_papers_reference_both_are_as_designed(paper, handbook):
    for robot in (paper, handbook):
        assert list(lived(robot, 25.0).values()) == pytest.approx([1] * 47, rel=1e-12)


def test_what_a_handbook_says_of_temperature_is_said_once(handbook):
    """At 45 °C: by the part's own equation, and by the paper's rule of ten kelvin where there is none."""
    found = lived(handbook, 45.0)
    motor = (2.17 * 2 + 40 * 2**0.5 + 6.401) / BY_HAND["Mobility/DC Motor"]
    expected = {
        BOARD + "Capacitor": arrhenius(0.35, 45),
        BOARD + "Resistor": arrhenius(0.08, 45),
        BOARD + "Diode": semiconductor(3091, 65) / semiconductor(3091, 45),  # its junction is 20 K warmer
        BOARD + "Inductor": arrhenius(0.11, 45 + 44, 25 + 44),
        DRIVER + "STM32F407VGT6": circuit(0.56, 0.35, 58, 100) / MICROCONTROLLER,
        BOARD + "Step Down Switching Regulator": circuit(0.020, 0.65, 78, 5) / circuit(0.020, 0.65, 58, 5),
        DRIVER + "16MHz Cryst. Osc.": 1, DSK_M + "Fuse": 1, "Power/Battery": 1, "Mobility/Encoder": 1,
        "Mobility/DC Motor": motor,
        **dict.fromkeys(KEPT, 4),
    }  # fmt: skip
    assert {path: found[path] for path in expected} == pytest.approx(expected, rel=1e-9)


@pytest.fixture
def printed(monkeypatch):
    """What a command prints."""

    def run(*words):
        streams = [io.TextIOWrapper(io.BytesIO(), encoding="utf-8") for _ in range(2)]
        monkeypatch.chdir(ROOT)
        for name, value in (("argv", ["robophm", *words]), ("stdout", streams[0]), ("stderr", streams[1])):
            monkeypatch.setattr(sys, name, value)
        with pytest.raises(SystemExit) as leaving:
            main()
        output = streams[0].buffer.getvalue().decode()
        monkeypatch.undo()
        assert not leaving.value.code
        return output

    return run


@pytest.mark.parametrize("command", ["check", "show", "task", "predict --draws 0"])
def test_the_commands_work(command, printed):
    verb, *options = command.split()
    assert "OTA by the handbooks" in printed(verb, "examples/ota/handbook.yaml", *options)


# The page.


PART = re.compile(r"\| [^|]+ \| \d\.\d\de-\d+ \|")


def number(value):
    """2.43e-7"""
    mantissa, power = f"{value:.2e}".split("e")
    return f"{mantissa}e{int(power)}"


def ratio(value):
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def row(path, given, ours):
    part = ours[path]
    name = path.rpartition("/")[2] + (f" ×{part.quantity}" if part.quantity > 1 else "")
    each = number(rate(given[path])), number(rate(part)), ratio(rate(part) / rate(given[path]))
    return "| " + " | ".join((name, *each)) + " | "


def test_the_page_has_every_part(paper, handbook, page):
    """In the order of the design, each with what the two designs say and a reason."""
    lines = [line for line in page.splitlines() if PART.match(line)]
    expected = [row(path, pieces(paper), pieces(handbook)) for path in pieces(paper)]
    assert [line[: len(start)] for line, start in zip(lines, expected, strict=True)] == expected
    assert all(len(line) > len(start) + 10 for line, start in zip(lines, expected, strict=True))


def test_what_is_not_explained_says_so(page):
    """The others are in test_ota_figures.py. The first page counts them too."""
    reasons = [line.rsplit("| ", 1)[1] for line in page.splitlines() if PART.match(line)]
    explained = [reason for reason in reasons if not reason.startswith("Not explained")]
    assert f"Of {len(reasons)} rows, {len(explained)} are explained" in " ".join(page.split())
    assert f"{len(reasons) - len(explained)} rates that nothing explains" in FIRST_PAGE.read_text(encoding="utf-8")


def test_the_pages_have_what_the_robots_promise(paper, page, printed):
    promised = [printed("show", f"examples/ota/{name}.yaml") for name in ("robot", "handbook")]
    for name in ("OTA", *(module.path for module in paper.modules)):
        line = rf"^ *{name}(?: by the handbooks)? {{2,}}(\S+ /h) +(\S+ %) +(.*?) *$"
        cells = [re.search(line, output, re.M).groups() for output in promised]
        side_by_side = " | ".join(cell for pair in zip(*cells, strict=True) for cell in pair)
        assert f"| **{name}** | {side_by_side} |" in page
        if name == "OTA":
            for design, of_robot in zip(("robot", "handbook"), cells, strict=True):
                line = f"| `robophm show examples/ota/{design}.yaml` | {' | '.join(of_robot)} |"
                assert line in FIRST_PAGE.read_text(encoding="utf-8")


def test_the_page_has_the_shares(paper, handbook, page):
    given, ours, said = pieces(paper), pieces(handbook), " ".join(page.split())

    def total(parts, paths):
        return math.fsum(rate(parts[path]) * parts[path].quantity for path in paths)

    launched = {BOARD + "Capacitor": 20 / 570, IPS + "Capacitor": 20 / 570, DSK_M + "Capacitor": 20 / 570,
                BOARD + "Inductor": 12 / 610, DRIVER + "Resettable Fuse": 8 / 230}  # fmt: skip
    cannon = math.fsum(total(given, [path]) * (1 - mobile) for path, mobile in launched.items())
    assert f"makes {number(cannon)} /h, {cannon / total(given, given):.0%} of all".replace("%", " %") in said
    assert f"{total(ours, KEPT) / total(ours, ours):.0%} of the handbooks' robot".replace("%", " %") in said
    read = [path for path, line in zip(given, filter(PART.match, page.splitlines()), strict=True)
            if "| Not explained" not in line]  # fmt: skip
    assert f"{total(given, read) / total(given, given):.0%} of the paper's rate".replace("%", " %") in said
    warm = lived(handbook, 45.0)
    lives = math.fsum(rate(part) * part.quantity * warm[path] for path, part in ours.items())
    assert f"the whole robot then has {lives / total(ours, ours):.2f} times its rate" in said


def test_the_page_has_what_decides(page, printed):
    for name, parts in (("robot", ("Capacitor", "Thermistor")), ("handbook", ("DC Motor", "Caster wheel"))):
        output = " ".join(printed("task", f"examples/ota/{name}.yaml").split())
        shares = [re.search(rf"{part} (\d+)\.\d* %", output).group(1) for part in parts]
        decided = next(line for line in page.split("**What decides**")[1].split(";") if f"{shares[0]} %" in line)
        assert f"{shares[1]} %" in decided
