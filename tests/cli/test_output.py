"""What is printed: JSON alone on stdout, no escape codes off a terminal, any terminal, any encoding, any reader."""

import json
import math
import os
import pty
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from robophm.cli import INVALID, OK
from robophm.cli.shared.output import SCHEMA_VERSION, json_text
from robophm.design.build import UNTAKEN

CDR = ["style=CDR", "capacitance=100 nF", "temperature=60 degC", "dc_voltage=8 V", "rated_voltage=16 V"]
SET = [word for pair in (*CDR, "environment=GM") for word in ("--set", pair)]
JSON = {
    "check": ("check", "robot.yaml", "--json"),
    "show": ("show", "robot.yaml", "--json"),
    "legacy": ("show", "robot.yaml", "--legacy", "--json"),
    "rates": ("rate", "--json"),
    "inputs": ("rate", "mil_hdbk_217f.capacitor", "--json"),
    "rate": ("rate", "mil_hdbk_217f.capacitor", *SET, "--json"),
    "predict": ("predict", "robot.yaml", "--json"),
    "doctor": ("doctor", "--json"),
}


@pytest.mark.parametrize("args", JSON.values(), ids=JSON.keys())
def test_one_document_with_its_version(inside, design, args):
    done = inside(*args)
    assert (done.returncode, done.stderr) == (OK, "")
    document = json.loads(done.stdout, parse_constant=pytest.fail)
    assert document["schema_version"] == SCHEMA_VERSION
    assert next(iter(document)) == "schema_version"


def test_warnings_stay_out_of_the_document(inside, design, recording):
    design.write_text(design.read_text() + "signals: {humidity: {topic: /h, field: relative_humidity}}\n")
    done = inside("check", design)
    assert done.returncode == OK
    assert done.stderr == f"warning: signals/humidity: {UNTAKEN}\n"
    assert json.loads(inside("check", design, "--json").stdout)["warnings"] == [done.stderr[9:].strip()]
    replayed = inside("replay", design, recording, "--json")
    assert json.loads(replayed.stdout)["schema_version"] == SCHEMA_VERSION
    assert replayed.stderr == done.stderr


def test_the_rate_of_a_part_worked_by_hand(inside):
    """0.0020 · πT(60 °C, 0.35 eV) · 0.1^0.09 · (1 + (5/6)³) · 10 · 20 failures/10⁶ h, as in the model's own test."""
    expected = 0.4e-6 * math.exp(0.35 / 8.617e-5 * (1 / 298 - 1 / 333)) * 0.1**0.09 * (1 + (5 / 6) ** 3)
    document = json.loads(inside("rate", "mil_hdbk_217f.capacitor", *SET, "--json").stdout)
    assert document["hazard_rate"] == pytest.approx(expected, rel=1e-12)
    assert document["unit"] == "1/h"
    shown = inside("rate", "mil_hdbk_217f.capacitor", *SET, "--explain", "--unit", "FIT").stdout
    assert shown.startswith(
        f"mil_hdbk_217f.capacitor: {expected * 1e9:,.0f} FIT\nλp = λb · πT · πC · πV · πSR · πQ · πE\n"
    )
    assert re.search(r"πQ +10 +quality commercial\n +πE +20 +environment GM", shown)
    assert "MIL-HDBK-217F Notice 2 §10.1" in shown


@pytest.mark.parametrize("args", [(), ("check",), ("show",), ("rate",), ("predict",), ("replay",), ("demo",)])
def test_help(inside, args):
    done = inside(*args, "--help")
    assert (done.returncode, done.stderr) == (OK, "")
    assert done.stdout.startswith("Usage: robophm")
    assert "None" not in done.stdout
    assert len(done.stdout.splitlines()) > 5


def test_the_schema_printed_is_the_schema_shipped(inside):
    from importlib.resources import files

    assert inside("schema").stdout == files("robophm.design").joinpath("robot.schema.json").read_text(encoding="utf-8")


def on_a_terminal(command, *args, **variables):
    """Exit code and all that a terminal gets."""
    ours, theirs = pty.openpty()
    env = {**os.environ, "TERM": "xterm-256color", "COLUMNS": "100", **variables}
    with subprocess.Popen([*command, *map(str, args)], stdin=theirs, stdout=theirs, stderr=theirs, env=env) as child:
        os.close(theirs)
        text = b""
        while True:
            try:
                more = os.read(ours, 65536)
            except OSError:
                break
            if not more:
                break
            text += more
    os.close(ours)
    return child.returncode, text.decode().replace("\r\n", "\n")


@pytest.mark.full
def test_colours_on_a_terminal_unless_they_are_not_wanted(command, design):
    assert "\x1b[1m" in on_a_terminal(command, "show", design)[1]
    for variables in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
        code, text = on_a_terminal(command, "show", design, **variables)
        assert code == OK
        assert "\x1b" not in text


@pytest.mark.full
@pytest.mark.parametrize("columns", ["0", "40", "abc"])
def test_figures_are_never_cut(command, design, columns):
    code, text = on_a_terminal(command, "show", design, COLUMNS=columns, NO_COLOR="1")
    assert code == OK
    assert "MTTF, calendar" in text
    assert "5.437e-4 /h" in text
    assert "58.06 %" in text


@pytest.mark.full
def test_a_pipe_gets_whole_lines_whatever_the_terminal(run, design):
    assert run("show", design, COLUMNS="40").stdout == run("show", design, COLUMNS="300").stdout


@pytest.mark.full
@pytest.mark.parametrize(
    "variables",
    [
        {"PYTHONIOENCODING": "ascii"},
        {"PYTHONIOENCODING": "latin-1"},
        {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"},
        {"LANG": "C", "LC_ALL": None, "HOME": None, "TERM": None},
    ],
    ids=["ascii", "latin-1", "C", "bare"],
)
def test_a_stdout_that_knows_few_characters(run, design, variables):
    design.write_text(design.read_text().replace("name: OTA", 'name: "Ω🤖"'), encoding="utf-8")
    shown = run("show", design, **variables)
    assert (shown.returncode, shown.stderr) == (OK, "")
    assert "58.06 %" in shown.stdout
    document = run("check", design, "--json", **variables)
    assert json.loads(document.stdout)["robot"] == "Ω🤖"
    missing = run("check", "röbot.yaml", **variables)
    assert missing.returncode == INVALID
    assert len(missing.stderr.splitlines()) == 1
    assert missing.stderr.startswith("error: r")


def test_a_file_name_that_is_no_text(run, design):
    odd = os.fsdecode(os.fsencode(design.parent) + b"/\xff.yaml")
    design.rename(odd)
    done = run("check", odd)
    assert (done.returncode, done.stderr) == (OK, "")
    assert "OTA is valid" in done.stdout


READERS = {
    "show": ("show", "robot.yaml"),
    "json": ("show", "robot.yaml", "--json"),
    "schema": ("schema",),
    "help": ("--help",),
    "wrong": ("check", "no.yaml"),
}


@pytest.mark.full
@pytest.mark.parametrize("args", READERS.values(), ids=READERS.keys())
def test_a_reader_that_has_seen_enough(command, design, args):
    """The exit code is the command's own, and nothing is said about the pipe."""
    reading, writing = os.pipe()
    os.close(reading)
    child = subprocess.run([*command, *args], stdout=writing, stderr=subprocess.PIPE, cwd=design.parent, check=False)
    os.close(writing)
    assert child.returncode == (INVALID if args[0] == "check" else OK)
    assert child.stderr.count(b"\n") == (args[0] == "check")


@pytest.mark.full
@pytest.mark.parametrize("args", [("show", "robot.yaml"), ("show", "robot.yaml", "--json"), ("--help",)])
def test_a_full_disk_behind_stdout(command, design, args):
    with open("/dev/full", "w") as full:  # noqa: PTH123
        child = subprocess.run([*command, *args], stdout=full, stderr=subprocess.PIPE, cwd=design.parent, check=False)
    assert child.returncode == INVALID
    assert child.stderr == b"error: standard output: No space left on device\n"


@pytest.mark.parametrize("stream", [">&-", "2>&-", ">&- 2>&- <&-"])
def test_closed_streams(command, design, stream):
    script = f'"$0" "$@" {stream}'
    assert subprocess.run(["sh", "-c", script, *command, "check", str(design)], check=False).returncode == OK
    assert subprocess.run(["sh", "-c", script, *command, "check", "no.yaml"], check=False).returncode == INVALID


@pytest.mark.full
def test_an_empty_folder_that_may_not_be_written(run, recording, tmp_path):
    from .conftest import EXAMPLE

    bare = tmp_path / "bare"
    bare.mkdir(mode=0o555)
    done = run("replay", EXAMPLE, recording, "--json", cwd=bare, HOME=None)
    assert (done.returncode, done.stderr) == (OK, "")
    assert list(bare.iterdir()) == []


def test_in_process_use_leaves_the_streams_alone():
    from typer.testing import CliRunner

    from robophm.cli.app import app

    before = sys.stdout, sys.stderr
    assert CliRunner().invoke(app, ["rate", "--json"]).exit_code == OK
    assert (sys.stdout, sys.stderr) == before


MICROCONTROLLER = [
    word
    for pair in (
        "family=CMOS", "bits=32 bit", "package=qfp", "pins=64", "power=0.5 W", "years_in_production=3 year",
        "environment=GM",
    )
    for word in ("--set", pair)
]  # fmt: skip


def test_what_is_assumed_stands_beside_what_was_said(inside):
    """The handbook's 50 °C of GM and 20 K/W of a small plastic die, which nobody said; both count: TJ is 60 °C."""
    asked = ("rate", "mil_hdbk_217f.microcircuit.processor", *MICROCONTROLLER)
    shown = inside(*asked, "--explain").stdout
    assert re.search(r"case_temperature +50 degC +assumed: the handbook's for the environment GM", shown)
    assert re.search(r"thermal_resistance +20 K/W +assumed: .* SMT-plastic with a small die", shown)
    assert re.search(r"quality +commercial +assumed: this model's default", shown)
    assert re.search(r"pins +64\n", shown)
    assumed = json.loads(inside(*asked, "--json").stdout)["assumed"]
    assert {name: one["value"] for name, one in assumed.items()} == {
        "die": "small", "case_temperature": 50, "thermal_resistance": 20, "quality": "commercial",
    }  # fmt: skip
    given = [word for pair in ("case_temperature=50 degC", "thermal_resistance=20 K/W") for word in ("--set", pair)]
    said = json.loads(inside(*asked, *given, "--json").stdout)
    assert said["hazard_rate"] == json.loads(inside(*asked, "--json").stdout)["hazard_rate"]
    assert set(said["assumed"]) == {"die", "quality"}


@pytest.mark.parametrize(
    ("unit", "expected"),
    [("/10^6 cycle", "2.77 /10^6 cycle"), ("/cycle", "2.77e-6 /cycle"), (None, "2.77e-6 /cycle")],
)
def test_a_rate_per_cycle_in_a_unit_of_cycles(inside, unit, expected):
    asked = ("rate", "nswc_11.solenoid", *(("--unit", unit) if unit else ()))
    assert inside(*asked).stdout == f"nswc_11.solenoid: {expected}\n"


def test_a_unit_that_measures_something_else_is_refused(inside):
    for json_too in ((), ("--json",)):
        done = inside("rate", "nswc_11.solenoid", "--unit", "FIT", *json_too)
        assert (done.returncode, done.stdout) == (INVALID, "")
        assert done.stderr == (
            "error: unit '1/cycle' does not measure what 'FIT' does; expected e.g. '1/cycle' or '/10^6 cycle'\n"
        )
    document = json.loads(
        inside("rate", "mil_hdbk_217f.fuse", "--set", "environment=GM", "--unit", "FIT", "--json").stdout
    )
    assert (document["hazard_rate"], document["unit"]) == (pytest.approx(80), "FIT")


def test_what_is_infinite_is_told_from_what_does_not_apply(inside, tmp_path):
    """Of a part alone: were it perfect nothing failed, RRW = F/0. Without a task there is no PoTC: null."""
    design = tmp_path / "one.yaml"
    design.write_text("schema_version: 1\nname: R\ncomponents: {a: {rate: 1 FPMH}}\n")
    done = inside("importance", design, "--json")
    document = json.loads(done.stdout, parse_constant=pytest.fail)
    units = {one["unit"]: one for one in document["importance"]["sensor_based"]["units"]}
    assert units["a"]["reduction"] == "Infinity"
    assert document["replacement"]["sensor_based"]["completion_failure"] is None
    plain = json_text({"up": math.inf, "down": -math.inf, "none": math.nan, "deep": [{"x": (math.inf,)}]})
    assert json.loads(plain) == {"up": "Infinity", "down": "-Infinity", "none": None, "deep": [{"x": ["Infinity"]}]}


@pytest.mark.full
def test_lines_go_out_as_they_are_written_also_into_a_pipe(command: list[str], design: Path) -> None:
    """Who waits for the address that a command prints has it while the command runs."""
    process = subprocess.Popen(
        [*command, "serve", str(design), "--port", "0"],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        env={name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"},
    )  # fmt: skip
    assert process.stdout is not None
    with process, ThreadPoolExecutor() as reader:
        try:
            assert "is served at http" in reader.submit(process.stdout.readline).result(timeout=20)
            assert process.poll() is None
        finally:
            process.kill()


def test_environments_are_explained_wherever_a_symbol_is_asked_for(inside, design):
    listed = inside("models", "environment").stdout
    assert "Ground, Mobile" in listed
    assert "vehicle" in listed
    rows = json.loads(inside("models", "environment", "--json").stdout)["environments"]
    assert next(row for row in rows if row["symbol"] == "ARW")["words"].startswith("flying, drone")
    taken = inside("rate", "mil_hdbk_217f.fuse", "--set", "environment=flying").stdout
    assert "environment 'flying' is taken as ARW (Airborne, Rotary Wing: " in taken
    design.write_text("schema_version: 1\nname: R\nenvironment: vehicle\n"
                      "components: {A: {hazard: {model: mil_hdbk_217f.fuse}}}\n")  # fmt: skip
    assert "note: environment GM (Ground, Mobile: on wheels" in inside("check", design).stderr
    assert json.loads(inside("check", design, "--json").stdout)["environments"] == {"GM": 1}
    assert "environment GM (Ground, Mobile: on wheels" in inside("show", design).stdout
