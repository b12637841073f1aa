"""0 ok, 1 threshold breached, 2 usage, 3 invalid input, 70 a defect; a mistake is one line and changes nothing."""

import pytest
import typer
import typer.core

from robophm.cli import BREACHED, DEFECT, INTERRUPTED, INVALID, OK, USAGE
from robophm.cli.app import app

CAPACITOR = ("rate", "mil_hdbk_217f.capacitor")


@pytest.mark.parametrize(
    "args",
    [
        ("check", "robot.yaml"),
        ("show", "robot.yaml", "--at", "0"),
        ("show", "robot.yaml", "--legacy"),
        ("rate",),
        ("predict", "robot.yaml", "--duration", "20 min"),
        ("doctor",),
        ("schema",),
    ],
    ids=" ".join,
)
def test_ok(inside, design, args):
    done = inside(*args)
    assert (done.returncode, done.stderr) == (OK, "")
    assert done.stdout
    assert "\x1b" not in done.stdout


@pytest.mark.parametrize(
    ("args", "code"),
    [(("check", "robot.yaml"), OK), (("chek",), USAGE), (("check", "no.yaml"), INVALID), (("--help",), OK)],
    ids=["ok", "usage", "invalid", "help"],
)
def test_a_process_of_its_own_leaves_with_the_code(run, design, args, code):
    done = run(*args)
    assert done.returncode == code
    assert "Traceback" not in done.stderr
    assert bool(done.stderr) == (code != OK)


def test_breached(inside, design):
    design.write_text(design.read_text().replace("completion: 0.99", "hazard_rate: 1 FIT"))
    done = inside("predict", design)
    assert done.returncode == BREACHED
    assert "threshold breached: " in done.stdout
    assert inside("predict", design, "--json").returncode == BREACHED
    assert inside("check", design).returncode == OK


@pytest.mark.parametrize(
    "args",
    [
        (),
        ("chek", "robot.yaml"),
        ("check",),
        ("check", "robot.yaml", "more"),
        ("check", "robot.yaml", "--jsn"),
        ("replay", "robot.yaml"),
        ("show", "robot.yaml", "--unit", "FOO"),
        ("show", "robot.yaml", "--unit", "FOO", "--json"),
        ("demo", "--seed", "x"),
    ],
    ids=" ".join,
)
def test_usage(inside, design, args):
    done = inside(*args)
    assert done.returncode == USAGE
    assert "Usage: robophm" in done.stdout + done.stderr
    assert not args or done.stdout == ""
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("args", "says"),
    [
        (("check", "robt.yaml"), "robt.yaml: no such file; did you mean 'robot.yaml'?"),
        (("check", "a\nb.yaml"), "a b.yaml: no such file"),
        (("check", "."), ".: cannot be read: Is a directory"),
        (("check", "/dev/null"), "/dev/null: holds no design; expected a mapping that starts with"),
        (("check", "/dev/zero"), "/dev/zero: is more than 20 MB"),
        (("show", "robot.yaml", "--at", "nan"), "--at nan: expected hours of at least 0"),
        (("show", "robot.yaml", "--at", "many"), "--at: 'many'"),
        (("show", "robot.yaml", "--at", "-1"), "--at -1: expected hours of at least 0"),
        (("show", "robot.yaml", "--at", "1e400"), "--at 1e400: expected hours of at least 0"),
        (("show", "robot.yaml", "--svg", "no/x.svg"), "no/x.svg: cannot be written: no such folder"),
        (("show", "robot.yaml", "--svg", "."), ".: cannot be written: is a folder"),
        (("show", "robot.yaml", "--svg", "robot.yaml"), "robot.yaml: is read or kept by this command too"),
        (
            ("rate", "mil_217f.capacitor"),
            "no hazard model 'mil_217f.capacitor'; did you mean 'mil_hdbk_217f.capacitor'?",
        ),
        (("rate", "../../os"), "no hazard model '../../os'"),
        ((*CAPACITOR, "--set", "style"), "--set style: expected INPUT=VALUE"),
        ((*CAPACITOR, "--set", "=5"), "has no input ''; known: "),
        ((*CAPACITOR, "--set", "stile=CDR"), "has no input 'stile'; did you mean 'style'?"),
        ((*CAPACITOR, "--set", "style=CDR", "--set", "style=CK"), "--set style=CK: 'style' is given twice"),
        (
            (*CAPACITOR, "--set", "style=CDR", "--set", "capacitance=5"),
            "capacitance: '5' has no unit; expected e.g. '5 u",
        ),
        ((*CAPACITOR, "--set", "style=CDR"), "needs the input 'capacitance' (1e-06 … 120000 uF)"),
        (("rate", "general.constant", "--set", "rate=__import__('os')"), "rate: '__import__('os')' is not a number"),
        (("predict", "robot.yaml", "--distance", "5"), "'5' has no unit; expected e.g. '5 m'"),
        (("predict", "robot.yaml", "--distance", "5 m"), "task: expected a distance with a speed above zero, or a dur"),
        (("predict", "robot.yaml", "--distance", "-5 m", "--speed", "1 m/s"), "task: distance -5 is negative"),
        (("predict", "robot.yaml", "--duration", ""), "'' is not a number with a unit; expected e.g. '1.5 h'"),
        (("predict", "robot.yaml", "--duration", "1e400 h"), "1e400 is not a finite number"),
        (("predict", "robot.yaml", "--duration", "5 km"), "unit 'km' does not measure what 'h' does"),
        (("predict", "robot.yaml", "--store", "no.db"), "no.db: no such store; `robophm replay --store` makes it\n"),
        (
            ("predict", "robot.yaml", "--store", "robot.yaml"),
            "robot.yaml: file is not a database; expected a robophm st",
        ),
        (("demo", "--to", "robot.yaml"), "robot.yaml: cannot be made: File exists"),
    ],
    ids=lambda value: " ".join(value).replace("\n", "~") if isinstance(value, tuple) else "",
)
def test_invalid_input(inside, design, args, says):
    before = design.read_bytes()
    done = inside(*args)
    assert (done.returncode, done.stdout) == (INVALID, "")
    assert done.stderr.startswith("error: ")
    assert says in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert design.read_bytes() == before
    assert list(design.parent.iterdir()) == [design]


def every_command():
    """Words that each command takes, whatever it is; those of groups too."""

    def words(command, before):
        inner = getattr(command, "commands", None)
        if inner:
            for name in sorted(inner):
                yield from words(command.get_command(None, name), [*before, name])
            return
        found = list(before)
        for one in command.params:
            if one.required:
                found += ["1"] if one.param_type_name == "argument" else [one.opts[0], "1"]
        yield found

    return list(words(typer.main.get_command(app), []))


DEFECTS = [KeyError(4), EOFError("two\nlines"), BrokenPipeError(32, "Broken pipe"), OSError(5, "Input/output error"),
           SystemExit("a library's last words"), RecursionError("deep")]  # fmt: skip


@pytest.mark.parametrize(
    ("words", "error"),
    [*((words, DEFECTS[0]) for words in every_command()), *((["schema"], error) for error in DEFECTS[1:])],
    ids=lambda value: " ".join(value) if isinstance(value, list) else type(value).__name__,
)
def test_a_defect_of_ours_is_never_taken_for_a_breached_threshold(inside, monkeypatch, words, error):
    def broken(*_):
        raise error

    monkeypatch.setattr(typer.core.TyperCommand, "invoke", broken)
    done = inside(*words)
    assert done.returncode == DEFECT == 70
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"error: {type(error).__name__}: ")
    assert line.endswith("a defect of robophm, not of your input; ROBOPHM_TRACEBACK=1 in the environment shows where "
                         "it comes from")  # fmt: skip


def test_the_traceback_of_a_defect_is_there_for_who_asks(inside, monkeypatch, design):
    monkeypatch.setenv("ROBOPHM_TRACEBACK", "1")
    monkeypatch.setattr("robophm.cli.check.load", lambda *_, **__: {}[4])
    done = inside("check", design)
    assert done.returncode == DEFECT
    assert done.stderr.startswith("Traceback (most recent call last):")
    assert "error: KeyError: 4 at test_exit_codes.py:" in done.stderr.splitlines()[-1]


def test_help_names_every_exit_code(inside):
    said = " ".join(inside("--help").stdout.split())
    for code in (OK, BREACHED, USAGE, INVALID, DEFECT, INTERRUPTED):
        assert f" {code} " in said.partition("Exit codes:")[2]
