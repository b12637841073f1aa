"""libyaml and ruamel.yaml read the same, letter for letter, or ruamel.yaml alone is asked."""

import io
import random
import sys
import time
import warnings
from pathlib import Path

import pytest
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from robophm.core import yaml_nodes as nodes
from robophm.core import yaml_values
from robophm.core.errors import DesignError
from robophm.core.yaml_nodes import Unsure, quick


@pytest.fixture(scope="session")
def examples():
    """The example designs."""
    return Path(__file__).resolve().parents[2] / "examples"


TOKENS = [
    *"\n \t#'\"[]{},:?!&*|>%@`~=-\\é🤖\u2028\x85\ufeff\x00\x7f",
    *("\r\n", "\r", "  ", "- ", ": ", " # c\n", "&a ", "*a", "!!str ", "|\n", "|-\n", ">\n", ">+\n", "|2\n", "---\n"),
    *("...\n", "%YAML 1.1\n---\n", "<<: ", "null", "yes", "0o17", "017", "1:20", "1_000", "1e3", ".inf", "a: b\n"),
    *("2020-01-01", "\\x41", "\\/", "{a: 1}", "? a\n: b\n", "\n\n", "   \n", "'a''b'", '"a\\\n  b"'),
]


def seen(node):
    """All that anybody asks of a node."""
    mark = node.start_mark
    said = [node.id, str(node.tag), mark.index, mark.line, mark.column, node.end_mark.index]
    if node.id == "scalar":
        return [*said, node.value]
    inner = [one for item in node.value for one in (item if isinstance(item, tuple) else (item,))]
    return [*said, bool(node.flow_style), *map(seen, inner)]


def agree(text):
    """Whether the quick reader had an answer; it must be the other's."""
    try:
        found = quick(text)
    except Unsure:
        return False
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of anchors that are used twice
        theirs = YAML(typ="safe", pure=True).compose(io.StringIO(text))  # a YAMLError here is a failure
    assert (theirs is None and found is None) or seen(found) == seen(theirs), repr(text)
    return True


@pytest.fixture(scope="module")
def designs(examples):
    return [path.read_text(encoding="utf-8") for path in sorted(examples.rglob("*.yaml"))]


def test_designs_are_read_alike(designs):
    assert len(designs) > 3
    for text in designs:
        agree(text)
    assert any(agree(text) for text in designs)


def test_damaged_designs_are_read_alike_or_not_at_all(designs):
    """Lines of real designs with what YAML finds special strewn in."""
    draw, quickly = random.Random(5), 0
    for _ in range(1500):
        lines = draw.choice(designs).splitlines(keepends=True)
        at = draw.randrange(len(lines))
        letters = list("".join(lines[at : at + 12]))
        for _ in range(draw.randrange(4)):
            place = draw.randrange(len(letters) + 1)
            letters[place : place + draw.randrange(2)] = draw.choice(TOKENS)
        quickly += agree("".join(letters).rstrip("\n") + "\n" * draw.randrange(2))
    assert quickly > 120


def test_any_tokens_are_read_alike_or_not_at_all():
    draw, quickly, aliases = random.Random(6), 0, 0
    for _ in range(3000):
        anchored = draw.choice(("", "x: &a 1\n", "x: &a [1]\n"))
        text = f"{anchored}a:\n  " + "".join(draw.choice(TOKENS) for _ in range(draw.randrange(1, 12)))
        text = text.rstrip("\n") + "\n" * draw.randrange(2)
        agreed = agree(text)
        quickly += agreed
        aliases += agreed and "*a" in text
    assert quickly > 100
    assert aliases > 5


@pytest.mark.parametrize(
    ("text", "quickly"),
    [
        ("a: &a {b: &b [1, 2]}\nc: *a\nd: [*b, *b]\n", True), ("a: &a\n  b: 1\nc:\n  - *a\n", True),
        ("a: &a [*a]\n", False), ("a: *b\n", False), ("a: &a 1\nb: &a 2\n", False), ("a: &a 1\n*a : 2\n", False),
        ("a: &1:2\n", False),
    ],
)  # fmt: skip
def test_anchors_are_read_alike_or_not_at_all(text, quickly):
    """YAML 1.2 §7.1; what refers to itself, to nothing or is a key is left to ruamel.yaml."""
    try:
        assert agree(text) is quickly
    except YAMLError:
        assert not quickly


@pytest.mark.parametrize(
    ("word", "value"),
    [
        ("no", "no"), ("on", "on"), ("y", "y"), ("1:20", "1:20"), ("0o17", 15), ("017", "017"), ("0x1F", 31),
        ("1e3", 1000.0), (".inf", float("inf")), ("True", True), ("null", None), ("~", None), ("1_000", 1000),
        ("2020-01-01", "2020-01-01"), ("'12'", "12"), ("12", 12), ("-1.5", -1.5), ("=", None), ("<<", None),
    ],
)  # fmt: skip
def test_words_are_those_of_yaml_1_2(word, value):
    """YAML 1.2 §10.3.2; in 1.1, which libyaml was made for, the first are booleans and 80."""
    root = quick(f"a: {word}\n")
    if word in ("=", "<<"):
        assert str(root.value[0][1].tag) == f"tag:yaml.org,2002:{'value' if word == '=' else 'merge'}"
    else:
        assert yaml_values._Reader("r").value(root, ()) == {"a": value}


@pytest.mark.parametrize(
    "line",
    [
        "a: [1, 2", "a: 'x", "a:\n b\n  c: 1", "a: \t1", "\ta: 1", "a: b: c", "a: \x07", "a: !x 1", "a: *b",
        "%YAML 3.0", "a: " + "[" * 200 + "]" * 200, "a: " + "[" * 1000, "- " * 5000, "a: {b: 1, b: 2}", "[a]: 1",
        "--- a\n--- b",
    ],
)  # fmt: skip
def test_faults_are_said_alike(line, monkeypatch):
    """With libyaml as where only ruamel.yaml reads; and deep nesting never fells the process."""
    found = []
    for without in (False, True):
        if without:
            monkeypatch.setitem(sys.modules, "yaml", None)
        try:
            found.append(yaml_values.values(line + "\n", "robot.yaml"))
        except DesignError as error:
            found.append(str(error))
    assert found[0] == found[1]
    assert isinstance(found[0], str)


def test_without_libyaml_nothing_differs(designs, monkeypatch):
    text = "".join(line for line in designs[0].splitlines(keepends=True))
    with_it = yaml_values.values(text, "r")
    monkeypatch.setitem(sys.modules, "yaml", None)
    with pytest.raises(Unsure):
        quick(text)
    assert yaml_values.values(text, "r") == with_it


def test_a_text_with_too_many_values_is_not_read_to_its_end(monkeypatch):
    monkeypatch.setattr(nodes, "MAX_VALUES", 1000)
    monkeypatch.setattr(yaml_values, "MAX_VALUES", 1000)
    text = "a: 1\nb:\n" + "  - {c: 2, d: [3]}\n" * 1200
    said = []
    for without in (False, True):
        if without:
            monkeypatch.setitem(sys.modules, "yaml", None)
        with pytest.raises(DesignError, match="unfolds to more than 1,000 values") as raised:
            yaml_values.values(text, "r")
        said.append(str(raised.value))
    assert said[0] == said[1]


def test_ruamel_keeps_the_last_word():
    with pytest.raises(YAMLError):
        nodes.compose("a: [\n")
    assert nodes.compose("# nothing\n") is None


def test_what_is_read_slowly_is_bounded(monkeypatch):
    """A gigabyte and minutes are what a 3 MB text takes that libyaml leaves to ruamel.yaml."""
    monkeypatch.setattr(nodes, "MAX_SLOW_NODES", 100)
    many = f"b: [{', '.join(['1'] * 101)}]\n"
    assert len(yaml_values.values(many, "plain.yaml")[0]["b"]) == 101
    with pytest.raises(DesignError, match=r"^slow\.yaml:2: has more than .*; .* no tags, tabs .* first is in line 1"):
        yaml_values.values(f"a: !x 1\n{many}", "slow.yaml")


LONG = 18_000_000
"""Characters of a text just within what a file may have."""


@pytest.mark.full
@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a: !x 1\n" + "# word\n" * (LONG // 7), r"slow:\d+: has more than 2,000,000 characters .* in line 1$"),
        ("a: 1\n" * 2_000 + "b: !x " + "word " * (LONG // 5) + "\n", "characters .* first is in line 2001$"),
        ("a: &a 1\nb: [" + "*a," * (LONG // 3) + "*a]\n", "slow:2: unfolds to more than 300,000 values"),
        ("- 1234567890123456\n" * (LONG // 19), "slow:300000: unfolds to more than 300,000 values"),
        pytest.param("".join(f"k{i}: 123456789\n" for i in range(LONG // 18)), "slow:300000: unfolds to more than",
                     marks=pytest.mark.full),
        pytest.param("a: !x 1\nb:\n" + "- 1234567890123456\n" * (LONG // 19), "than 80,000 keys and values .* line 1$",
                     marks=pytest.mark.full),
    ],
    ids=["remarks", "words", "aliases", "items", "keys", "items read slowly"],
)  # fmt: skip
def test_a_long_text_is_refused_in_seconds(text, says):
    """By ruamel.yaml alone these took 10 to 30 s; a second each by processor time, on a machine that does no more."""
    begun = time.process_time()
    with pytest.raises(DesignError, match=says):
        yaml_values.values(text, "slow")
    assert time.process_time() - begun < 8


def test_a_long_text_with_an_anchor_is_read_as_quickly_as_one_without():
    text = 'a: &a 1\nb: *a\nc: "' + "word " * (LONG // 5) + '"\n'
    begun = time.process_time()
    assert yaml_values.values(text, "long")[0]["b"] == 1
    assert time.process_time() - begun < 4


@pytest.mark.parametrize("digits", ["0x" + "f" * 5000, "0o" + "7" * 5000, "9" * 5000])
def test_a_number_that_cannot_be_written_again_is_a_text(digits):
    assert yaml_values.values(f"a: {digits}\n", "design")[0] == {"a": digits}


def test_each_key_has_the_line_and_column_that_ruamel_tells(designs):
    """By its round trip, which keeps where keys and items stand."""
    text = max(designs, key=len)
    lines = yaml_values.values(text, "design")[1]

    def places(node, place=()):
        if isinstance(node, dict):
            for key, value in node.items():
                yield (*place, key), node.lc.key(key)
                yield from places(value, (*place, key))
        elif isinstance(node, list):
            for i, value in enumerate(node):
                yield (*place, str(i)), node.lc.item(i)
                yield from places(value, (*place, str(i)))

    told = {place: (line + 1, column + 1) for place, (line, column) in places(YAML().load(text))}
    assert len(told) > 50
    assert told == {place: (line, lines.columns[place]) for place, line in lines.items() if place}
    assert lines.nearest((*next(iter(told)), "nothing", "of it")) == told[next(iter(told))]
    assert yaml_values.Lines().nearest(("a",)) is None
