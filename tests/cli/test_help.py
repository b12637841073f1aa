"""The command line for people: groups of commands, one name for one thing, shells, standard input, extras."""

import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import tomllib
from pathlib import Path
from shutil import which

import pytest
import typer

from robophm.cli.app import COMMANDS, FORMER, GROUPS, SOUGHT, app
from robophm.cli.doctor import EXTRAS
from robophm.cli.shared.options import operating_time
from robophm.core.errors import RobophmError

ROOT = Path(__file__).parents[2]
DEVELOPERS = {"dev", "bench", "peers", "docs"}


def options():
    """Every option of every command: (command, option)."""
    root = typer.main.get_command(app)
    for name in COMMANDS:
        group = root.get_command(None, name)
        inner = [group.get_command(None, one) for one in group.list_commands(None)] if hasattr(group, "lines") else []
        for command in inner or [group]:
            for parameter in getattr(command, "params", ()):
                yield from ((name, option) for option in parameter.opts)


@pytest.mark.parametrize(
    ("commands", "without"),
    [
        ((["parts", "lidar"], ["models", "resistor"]), ("scipy", "pint", "pandas", "matplotlib")),
        (
            (["check", "examples/arm/robot.yaml"], ["predict", "examples/arm/robot.yaml"]),
            ("scipy.stats", "pint", "pandas"),
        ),
    ],
)
def test_a_command_loads_no_library_that_it_does_not_need(commands, without):
    """Libraries take longer to load than most commands work."""
    code = (
        "import sys; from robophm.cli.app import app\n"
        f"for words in {commands}: app(words, standalone_mode=False)\n"
        f"print(sorted(set({without}) & set(sys.modules)), file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stderr.strip().endswith("[]"), done.stderr[-500:]


def test_each_command_is_in_one_group():
    listed = [name for names in GROUPS.values() for name in names]
    assert sorted(listed) == sorted(COMMANDS)


def test_the_help_lists_the_groups_with_each_command_in_full(inside, monkeypatch):
    said = inside("--help").stdout
    for title, names in GROUPS.items():
        part = said.partition(f"{title}:\n")[2].partition("\n\n")[0]
        assert re.findall(r"^  ([a-z][\w-]*)", part, re.MULTILINE) == list(names)
    assert "..." not in said.partition("\n")[2]
    for line in COMMANDS.values():
        assert line in " ".join(said.split())


def test_one_thing_has_one_name():
    known = set(options())
    names = {option for _, option in known}
    assert not names & {"--output", "--out", "--after", "--time"}
    assert {name for name, option in known if option == "--hours"} == {"new"}  # hours a day, which is another thing
    for (command, old), new in FORMER.items():
        assert (command, new) in known
        assert (command, old) not in known or old == new


def test_a_former_name_is_taken_and_said(inside, design):
    now, then = inside("show", "robot.yaml", "--at", "50"), inside("show", "robot.yaml", "--hours=50")
    assert (then.returncode, then.stdout) == (now.returncode, now.stdout) == (0, now.stdout)
    assert (now.stderr, then.stderr) == ("", "note: --hours of show is called --at now\n")


def test_a_command_is_found_by_what_people_call_it(inside):
    now, sought = inside("new", "--help"), inside("draft", "--help")
    assert (sought.returncode, sought.stdout) == (now.returncode, now.stdout) == (0, now.stdout)
    assert sought.stderr == "note: draft is called new\n"
    assert not SOUGHT.keys() & COMMANDS.keys()


@pytest.mark.parametrize(("text", "hours"), [("50", 50), (50.0, 50), ("50 h", 50), ("2 week", 336), ("1e3", 1000),
                                             ("90 min", 1.5), ("0", 0)])  # fmt: skip
def test_times_of_operation_are_hours_or_have_a_unit(text, hours):
    assert operating_time("--at", text) == hours


@pytest.mark.parametrize("text", ["", "-1", "nan", "inf", "1e10", "many", "5 km", "1 h h"])
def test_what_is_no_time_is_refused_with_the_options_name(text):
    with pytest.raises(RobophmError, match=r"^--within"):
        operating_time("--within", text)
    with pytest.raises(RobophmError, match="above 0"):
        operating_time("--within", "0", above=True)


@pytest.mark.full
@pytest.mark.parametrize(
    ("words", "found"),
    [("im", {"import-bom", "import-legacy", "importance"}), ("show robot.yaml --a", {"--at"}),
     ("predict robot.yaml --future ", {"recent", "last", "nominal"}), ("data ", {"list", "find", "export"})],
)  # fmt: skip
def test_a_real_bash_completes(tmp_path, words, found):
    """By the script that the command prints, with robophm as a function of that shell."""
    program, script = tmp_path / "robophm", tmp_path / "complete.sh"
    program.write_text(f'#!/bin/bash\nexec "{sys.executable}" -m robophm "$@"\n')
    program.chmod(0o755)
    typed = [repr(word) for word in ["robophm", *words.split(" ")]]
    script.write_text(
        f"export SHELL=/bin/bash\nsource <(./robophm --show-completion bash)\nCOMP_WORDS=({' '.join(typed)})\n"
        f'COMP_CWORD={len(typed) - 1}\n_robophm_completion ./robophm\nprintf "%s\\n" "${{COMPREPLY[@]}}"\n'
    )
    done = subprocess.run(["bash", script], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert found <= set(done.stdout.split())


def without(shell):
    """Whether a shell is not here, and what is said then."""
    return pytest.mark.skipif(which(shell) is None, reason=f"no {shell} (sudo sh tools/ros-peers installs it)")


@pytest.fixture
def program(tmp_path, monkeypatch):
    """``robophm`` as a shell finds it; a shell is told by the process that asks for its script."""
    path = tmp_path / "bin" / "robophm"
    path.parent.mkdir()
    path.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m robophm "$@"\n')
    path.chmod(0o755)
    monkeypatch.setenv("PATH", f"{path.parent}:{os.environ['PATH']}")
    monkeypatch.chdir(tmp_path)
    return path


@pytest.mark.full
@without("fish")
def test_a_real_fish_completes(program):
    script = "robophm --show-completion | source; complete -C 'robophm im'; complete -C 'robophm show robot.yaml --a'"
    done = subprocess.run(["fish", "--no-config", "-c", script], capture_output=True, text=True, check=True)
    found = {line.partition("\t")[0] for line in done.stdout.splitlines()}
    assert found == {"import-bom", "import-legacy", "importance", "--at"}
    assert "Rank parts by their importance" in done.stdout


@pytest.mark.full
@without("zsh")
def test_a_real_zsh_completes(program):
    """On a terminal, for it completes nowhere else: what is typed is completed as far as it is plain, then listed."""
    child, terminal = pty.fork()
    if not child:
        os.environ.update(PS1="> ", TERM="dumb", SHELL="zsh")
        os.execvp("zsh", ["zsh", "-f", "-i"])
    told = b""

    def until(*words):
        nonlocal told
        while not all(word.encode() in told for word in words):
            ready, _, _ = select.select([terminal], [], [], 300)
            assert ready, told
            told += os.read(terminal, 4096)
        told = b""

    try:
        os.write(terminal, b"autoload -Uz compinit && compinit -u -D; robophm --show-completion >complete.zsh; ")
        os.write(terminal, b"source complete.zsh; print re''ady\n")
        until("ready")
        os.write(terminal, b"robophm im\t")
        until("import")
        os.write(terminal, b"\t")
        until("import-bom", "import-legacy", "importance", "Rank parts by")
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        os.close(terminal)


@pytest.mark.full
def test_standard_input_is_read_where_a_file_is(run, design):
    text = design.read_text()
    command = [sys.executable, "-m", "robophm"]
    for words in (["check", "-"], ["show", "-", "--json"], ["predict", "-", "--draws", "0", "--json"]):
        given = subprocess.run([*command, *words], input=text, capture_output=True, text=True, cwd=design.parent)
        named = [*command, words[0], "robot.yaml", *words[2:]]
        read = subprocess.run(named, capture_output=True, text=True, cwd=design.parent)
        assert (given.returncode, given.stderr) == (read.returncode, read.stderr)
        assert given.stdout.replace("-: ", "robot.yaml: ") == read.stdout
    wrong = subprocess.run([*command, "check", "-"], input="name: 3\n", capture_output=True, text=True)
    assert (wrong.returncode, wrong.stdout) == (3, "")
    assert wrong.stderr.startswith("error: -:1: schema_version: not stated; expected 1")
    written = subprocess.run([*command, "bind", "-", "drive.mcap", "--yes"], input=text, capture_output=True, text=True,
                             cwd=design.parent)  # fmt: skip
    assert written.returncode == 3
    assert "-: is standard input, which is read" in written.stderr
    assert list(design.parent.iterdir()) == [design]


def test_doctor_tells_of_the_extras_of_this_project(inside):
    stated = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    assert set(EXTRAS) == set(stated) - DEVELOPERS
    for name, (_, packages) in EXTRAS.items():
        assert [re.match(r"[\w-]+", one)[0] for one in stated[name]] == list(packages)
    said = inside("doctor").stdout
    told = json.loads(inside("doctor", "--json").stdout)["extras"]
    for name, one in told.items():
        line = next(line for line in said.splitlines() if line.startswith(f"extra {name} "))
        assert ("not installed" in line) == bool(one["missing"])
        assert not one["missing"] or f"pip install 'robophm[{name}]'" in line
