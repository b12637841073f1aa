"""A user's arithmetic against Python's own on what both may read, and everything else refused with its place."""

import ast
import math
import operator
import random
import time

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.core.expression import DEEPEST, LONGEST_EXPRESSION, MOST_STEPS, check_name, read

MATH = {
    "exp": math.exp, "log": math.log, "log10": math.log10, "sqrt": math.sqrt, "abs": abs, "min": min, "max": max,
    "pow": pow, "pi": math.pi, "e": math.e,
}  # fmt: skip
VALUES = {"x": 2.5, "y": -0.75, "load_2": 7.0}


def found(text, **values):
    return float(read(text, values or VALUES)(values or VALUES))


@pytest.mark.parametrize(
    ("text", "by_hand"),
    [
        ("1 + 2 * 3", 7), ("(1 + 2) * 3", 9), ("2 - 3 - 4", -5), ("16 / 4 / 2", 2), ("2 ** 3 ** 2", 512),
        ("-2 ** 2", -4), ("2 ** -1", 0.5), ("--3", 3), ("+-+3", -3), ("2 * -3", -6), ("-(1 + 2)", -3), ("2e3", 2000),
        (".5", 0.5), ("5.", 5), ("1.5E-2", 0.015), ("min(3, 1, 2)", 1), ("max(3, 1, 2)", 3), ("pow(2, 10)", 1024),
        ("log10(1000)", 3), ("log(e)", 1), ("sqrt(16)", 4), ("abs(-3)", 3), ("exp(0)", 1), ("cos_ * 2", 8),
        ("\t1\n+\r\n1 ", 2),
    ],
)  # fmt: skip
def test_by_hand(text, by_hand):
    assert found(text, cos_=4.0) == pytest.approx(by_hand, rel=1e-15)


def random_text(draw, depth):
    """A text that Python and we both read; powers of positive numbers alone."""
    if depth == 0 or draw.random() < 0.15:
        return draw.choice(["x", "y", "load_2", "pi", "e", "3", "0.25", "1.5e-1"])
    inner = [random_text(draw, depth - 1) for _ in range(3)]
    return draw.choice(
        [
            f"{inner[0]} + {inner[1]}", f"{inner[0]} - {inner[1]}", f"{inner[0]} * {inner[1]}", f"-{inner[0]}",
            f"({inner[0]}) / (1 + abs({inner[1]}))", f"({inner[0]} - {inner[1]})", f"exp(-abs({inner[0]}))",
            f"log(1 + abs({inner[0]}))", f"sqrt(abs({inner[0]}))", f"min({inner[0]}, {inner[1]}, {inner[2]})",
            f"max({inner[0]}, {inner[1]})", f"abs({inner[0]}) ** 2", f"2 ** -abs({inner[0]}) ** 0.5",
            f"pow(1 + abs({inner[0]}), 0.5)", f"log10(2 + abs({inner[0]}))",
        ]
    )  # fmt: skip


BINARY = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: pow,
}  # fmt: skip


def by_python(node):
    """The value of what Python's own parser makes of a text."""
    match node:
        case ast.Constant(value):
            return value
        case ast.Name(name):
            return (MATH | VALUES)[name]
        case ast.BinOp(left, sign, right):
            return BINARY[type(sign)](by_python(left), by_python(right))
        case ast.UnaryOp(ast.USub(), of):
            return -by_python(of)
        case ast.Call(ast.Name(name), arguments):
            return MATH[name](*map(by_python, arguments))
    pytest.fail(ast.dump(node))


def test_it_computes_what_python_computes():
    draw = random.Random(7)
    compared = 0
    for _ in range(600):
        text = random_text(draw, 4)
        if len(text) > LONGEST_EXPRESSION:
            continue
        try:
            ours = found(text)
        except ModelError:
            continue  # one of the limits
        assert ours == pytest.approx(by_python(ast.parse(text, mode="eval").body), rel=1e-12)
        compared += 1
    assert compared > 400


def test_arrays_are_numbers_side_by_side():
    expression = read("a * exp(-b / 3) + max(a, b)", ["a", "b"])
    a, b = np.linspace(-2, 2, 5)[:, None], np.linspace(0, 9, 4)
    value = expression({"a": a, "b": b})
    assert value.shape == (5, 4)
    alone = [[float(expression({"a": float(one), "b": float(two)})) for two in b] for one in a[:, 0]]
    assert value.tolist() == pytest.approx(np.array(alone), rel=1e-15)
    assert expression.names == ("a", "b")


def test_no_answer_is_no_number_and_no_warning():
    assert math.isnan(found("log(-1)"))
    assert math.isnan(found("sqrt(0 - 1)"))
    assert math.isnan(found("(0 - 2) ** 0.5"))
    assert found("1 / 0") == math.inf
    assert found("exp(1e9)") == math.inf


@pytest.mark.parametrize("text", ["9**9**9", "9**9**9**9**9**9", "pow(9, pow(9, pow(9, 9)))", "1e308 * 1e308"])
def test_towers_cost_nothing(text):
    begun = time.process_time()
    assert found(text) == math.inf
    assert time.process_time() - begun < 2


REFUSED = {
    "": "character 1: expected a number, a variable, a function or '('; found the end",
    "   ": "expected a number, a variable",
    "1 +": "character 4: expected a number, a variable, a function or '('; found the end",
    "1 2": "character 3: expected an operator or the end; found '2'",
    "(1": "character 3: expected ')'; found the end",
    "1)": "character 2: expected an operator or the end; found ')'",
    "1 // 2": "character 4: expected a number",
    "x % 2": "character 3: expected a number, a name or one of",
    "x ^ 2": "character 3: expected a number, a name or one of",
    "x = 2": "character 3: expected a number, a name or one of",
    "x == 2": "character 3",
    "x if y else 1": "character 3: expected an operator or the end; found 'if y else 1'",
    "lambda: 1": "no variable or function 'lambda'",
    "lod_2": "no variable or function 'lod_2'; did you mean 'load_2'?",
    "x.real": "character 2: expected a number, a name or one of",
    "x.__class__": "character 2",
    "1.real": "character 3: expected an operator or the end; found 'real'",
    "().__class__.__bases__[0]": "character 2: expected a number, a variable",
    "__import__('os').system('x')": "no variable or function '__import__'",
    "exp.__globals__": "character 4",
    "exp": "character 4: expected '(' after exp; found the end",
    "exp x": "expected '(' after exp",
    "x(1)": "character 2: expected an operator or the end; found '(1)'",
    "exp()": "character 5: expected a number",
    "exp(1, 2)": "expected exp to take 1, not 2,",
    "pow(1)": "expected pow to take 2, not 1,",
    "min(1)": "expected min to take at least 2, not 1,",
    "(1, 2)": "expected ')'; found ', 2)'",
    "min(1,,2)": "character 7: expected a number",
    "[1]": "character 1",
    "'a'": "character 1",
    "1; 2": "character 2",
    "x # y": "character 3",
    "1\x002": "character 2",
    "\uff12 + 1": "character 1",  # a full-width 2
    "\u03c0 * x": "character 1",  # π
    "x\u00a0+ 1": "character 2",  # a blank that is none
    "x\u2212y": "character 2",  # a minus sign that is none
    "\u0445 + 1": "character 1",  # a Cyrillic х
    "1e999": "expected a number that is not too large or long",
    "1" * 41: "expected a number that is not too large or long",
    "0x10": "character 2: expected an operator or the end",
    "1_000": "character 2: expected an operator or the end",
    "1j": "expected an operator or the end",
    "True": "no variable or function 'True'",
    "nan": "no variable or function 'nan'",
    "inf": "no variable or function 'inf'",
    "(" * (DEEPEST + 1) + "1" + ")" * (DEEPEST + 1): f"at most {DEEPEST} parentheses",
    "(" * 900: f"at most {DEEPEST} parentheses",
    "-" * 900 + "1": f"at most {DEEPEST} parentheses",
    "2**" * 200 + "1": f"at most {DEEPEST} parentheses",
    "exp(" * 200: f"at most {DEEPEST} parentheses",
    "1" + "+1" * (MOST_STEPS // 2): f"at most {MOST_STEPS} numbers",
    "x" * (LONGEST_EXPRESSION + 1): f"{LONGEST_EXPRESSION + 1} characters long; expected at most {LONGEST_EXPRESSION}",
    "(" * 10**6: "1000000 characters long",
}


@pytest.mark.parametrize("text", REFUSED, ids=lambda text: repr(text[:30]))
def test_everything_else_is_refused_with_its_place(text):
    begun = time.process_time()
    with pytest.raises(ModelError) as caught:
        read(text, VALUES)
    assert REFUSED[text] in str(caught.value)
    assert "\n" not in str(caught.value)
    assert time.process_time() - begun < 2


def test_up_to_the_limits():
    assert found("(" * DEEPEST + "1" + ")" * DEEPEST) == 1
    assert found("1" + "+1" * ((MOST_STEPS - 1) // 2)) == 1 + (MOST_STEPS - 1) // 2


def test_noise_is_read_or_refused():
    draw = random.Random(11)
    read_ = 0
    pieces = ["x", "1", ".", "e", "+", "-", "*", "/", "(", ")", ",", " ", "min", "exp", "_", "\u00b2"]
    for _ in range(4000):
        text = "".join(draw.choice(pieces) for _ in range(draw.randrange(1, 12)))
        try:
            assert read(text, ["x"])({"x": 2.0}).shape == ()
            read_ += 1
        except ModelError:
            continue
    assert read_ > 100


@pytest.mark.parametrize("name", ["2x", "x.y", "", "x y", "exp", "pi", "e", "\u03c0", "x" * 101, "x\n"])
def test_names_that_no_variable_may_have(name):
    with pytest.raises(ModelError, match="cannot be a variable"):
        check_name(name)
