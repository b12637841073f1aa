"""Dynamic fault trees in the Galileo format: figures that Storm's tests print, closed forms, and what is refused."""

import math
import time

import pytest
from scipy.special import gammainc, ndtr

import robophm
from robophm.blocks.dynamic_chain import DynamicChain
from robophm.core.errors import DesignError, StructureError
from robophm.design.importers.galileo import load

from ...cases import each_case

HALF, WARM = "lambda=0.5 dorm=0", "lambda=0.5 dorm=0.3"
MEAN_TIMES = {
    "two in parallel": ("A and B C", {"B C": WARM}, 3),
    "2 of 3": ("A 2of3 B C D", {"B": "lambda=0.3", "C": "lambda=0.4", "D": "lambda=1"}, 2685 / 1547),
    "order of two": ("A pand B C", {"B C": "lambda=0.4 dorm=0.3"}, math.inf),
    "first of three": ("A por B C D", {"B": "lambda=0.4", "C D": "lambda=0.2"}, math.inf),
    "one fails the other": ("A and B C; F fdep B C", {"B C": HALF}, 2),
    "a dependency among the inputs": ("A and B C F; F fdep B C", {"B": "lambda=0.4", "C": "lambda=0.8"}, 5 / 2),
    "power": ("S or P M; P fdep X Y Z; M or Y Z", {"X Y": HALF, "Z": "lambda=0.5 dorm=0.5"}, 2 / 3),
    "a trigger of what is in use and of its spare": (
        "A or F B; F fdep E C D; B wsp C D", {"C": "lambda=1 dorm=0", "D": "lambda=1 dorm=0.5", "E": HALF}, 1),
    "one fails two of four": ("A and B C D E; F fdep B C D", {"B C D E": HALF}, 3),
    "perhaps": ("T or A B P; A pand S M; B and M N; P pdep=0.2 M S", {"S M N": HALF}, 8 / 3),
    "perhaps each of two": ("T or A B P; A pand S M; B and M N; P pdep=0.2 M S N", {"S M N": HALF}, 38 / 15),
    "perhaps one of two": ("A and B C F; F pdep=0.3 B C", {"B": "lambda=0.4", "C": "lambda=0.8"}, 67 / 24),
    "warm": ("A wsp I M", {"I M": WARM}, 46 / 13),
    "two share a spare": ("A or B C; B wsp I J; C wsp M J", {"I J M": WARM}, 43 / 23),
    "three share a spare": ("A or B C D; B wsp I M; C wsp J M; D wsp K M", {"I J K M": WARM}, 14 / 11),
    "two of unlike spares": ("A and B C; B wsp I J K; C wsp M J", {"I J K M": WARM}, 18836 / 3887),
    "a module as a spare": ("A wsp I B; B or C J; C or K L", {"I J K L": HALF}, 8 / 3),
    "spares in a row": ("A wsp K J I", {"I K": "lambda=0.5 dorm=0.5", "J": "lambda=1 dorm=0.5"}, 551 / 150),
    "a spare gate as a spare": ("A wsp I B; B wsp J K", {"I J K": WARM}, 249 / 52),
    "what claims a spare although it does not matter": (
        "T and E S; E or D R; R wsp A C; S wsp B C",
        {"A": "lambda=2", "B": "lambda=3", "C": "lambda=5 dorm=0.5", "D": "lambda=7"}, 78311 / 182700),
    "one after the other": ("A and B C; X seq B C", {"B C": WARM}, 4),
    "after what is not asked for": ("A and C D; X seq B C D", {"B C D": WARM}, 6),
    "against the order": (
        "A and T U; T pand B C; U pand D E; X seq E D", {"B E": "lambda=0.7", "C D": "lambda=0.5"}, math.inf),
    "a spare that waits for a switch": (
        "T wsp A C; X seq O C; O or F; D fdep A F",
        {"A": "lambda=1e-4", "C": "lambda=5e-5 dorm=0", "F": "lambda=0"}, 30000),
    "never both": ("T and A B C; M mutex B C", {"A": "lambda=2", "B": "lambda=4", "C": "lambda=5"}, math.inf),
}  # fmt: skip
"""Mean times to failure as Storm's tests print them (src/test/storm-dft/api/DftModelCheckerTest.cpp)."""


def written(folder, gates, events):
    path = folder / "tree.dft"
    lines = [f'toplevel "{gates.split()[0]}";']
    lines += [" ".join(f'"{word}"' if i != 1 else word for i, word in enumerate(said.split())) + ";"
              for said in gates.split(";")]  # fmt: skip
    lines += [f'"{name}" {law};' for names, law in events.items() for name in names.split()]
    path.write_text("\n".join(lines) + "\n")
    return path


@each_case(("gates", "events", "expected"), MEAN_TIMES.values())
def test_mean_times_that_storm_prints(tmp_path, gates, events, expected):
    tree = load(written(tmp_path, gates, events))
    assert DynamicChain(tree.tree).mean_time() == pytest.approx(expected, rel=1e-12)
    assert tree.solved(1.0).mean_time == pytest.approx(expected, rel=1e-12)


def test_two_computers_of_which_each_has_a_shared_spare(tmp_path):
    """The hypothetical example computer system twice: 0.00021997582 at 1 h, as Storm's tests print it."""
    gates, events = ["S or S1 S2"], {}
    for i in "12":
        gates += [
            f"S{i} or P{i} M{i} B{i} I{i}",
            f"P{i} and X{i} Y{i}",
            f"X{i} wsp a{i} s{i}",
            f"Y{i} wsp b{i} s{i}",
            f"M{i} 3of5 {' '.join(f'm{i}{j}' for j in range(5))}",
            f"B{i} and d{i} e{i}",
            f"I{i} or h{i} w{i}",
        ]
        events |= {f"a{i} b{i} s{i}": "lambda=1e-4 dorm=0", " ".join(f"m{i}{j}" for j in range(5)): "lambda=6e-5",
                   f"d{i} e{i}": "lambda=1e-6", f"h{i}": "lambda=5e-5", f"w{i}": "lambda=6e-5"}  # fmt: skip
    found = load(written(tmp_path, ";".join(gates), events)).solved(1.0)
    assert found.probability == pytest.approx(0.00021997582, rel=5e-7)
    assert found.states == (8, 8)


def test_in_python(tmp_path):
    path = written(tmp_path, "A csp B C", {"B C": HALF})
    found = robophm.dynamic_tree(path, 2.0)
    assert (found.probability, found.mean_time) == (pytest.approx(1 - 2 * math.exp(-1), rel=1e-12), pytest.approx(4))
    with pytest.raises(robophm.RobophmError, match=r"no\.dft: cannot be read"):
        robophm.dynamic_tree(tmp_path / "no.dft", 1.0)


def test_closed_forms(tmp_path):
    def at(gates, events, hours):
        return load(written(tmp_path, gates, events)).solved(hours).probability

    cold = at("A csp B C D E", {"B C D E": "lambda=0.3 dorm=0"}, 5.0)
    assert cold == pytest.approx(gammainc(4, 1.5), rel=1e-12)
    rare = at("A csp B C D E", {"B C D E": "lambda=1e-8 dorm=0"}, 1.0)
    assert rare == pytest.approx(1e-32 / 24, rel=1e-7)  # with all digits
    hot = at("A hsp B C", {"B C": "lambda=0.3 dorm=1"}, 2.0)
    assert hot == pytest.approx((1 - math.exp(-0.6)) ** 2, rel=1e-12)
    a, b, t = 0.7, 0.2, 3.0
    first = 1 - math.exp(-b * t) - b / (a + b) * (1 - math.exp(-(a + b) * t))  # b by t, and a before it
    assert at("A pand B C", {"B": f"lambda={a}", "C": f"lambda={b}"}, t) == pytest.approx(first, rel=1e-12)
    por = a / (a + b) * (1 - math.exp(-(a + b) * t))
    assert at("A por B C", {"B": f"lambda={a}", "C": f"lambda={b}"}, t) == pytest.approx(por, rel=1e-12)


def test_at_one_moment_is_in_order_unless_it_must_be_before(tmp_path):
    """Both inputs fail by one event: 1 − exp(−1), or never."""
    for kind, expected in (("pand", 1 - math.exp(-1)), ("pand<=", 1 - math.exp(-1)), ("pand-excl", 0), ("pand<", 0)):
        tree = load(written(tmp_path, f"A {kind} B C; B or x; C or x", {"x": "lambda=1"}))
        assert tree.solved(1.0).probability == pytest.approx(expected, rel=1e-12), kind
    for kind, expected in (("por", 1 - math.exp(-1)), ("por<=", 1 - math.exp(-1)), ("por-excl", 0)):
        tree = load(written(tmp_path, f"A {kind} B C; B or x; C or x", {"x": "lambda=1"}))
        assert tree.solved(1.0).probability == pytest.approx(expected, rel=1e-12), kind


def test_laws_of_static_events(tmp_path):
    laws = {
        "lambda=4 phases=3": gammainc(3, 8), "prob=0.4": 0.4, "rate=0.3 shape=2": 1 - math.exp(-0.36),
        "mean=0.5 stddev=1": ndtr(math.log(2) - 0.5), "prob=1": 1, "prob=0": 0,
    }  # fmt: skip
    for law, expected in laws.items():
        tree = load(written(tmp_path, "A or B C", {"B": law, "C": "prob=0"}))
        assert tree.solved(2.0).probability == pytest.approx(expected, rel=1e-12), law
    with pytest.raises(StructureError, match="'B' has no constant rate"):
        load(written(tmp_path, "A wsp B C", {"B": "rate=1 shape=2", "C": "lambda=1"})).solved(1.0)


def test_where_the_order_at_one_moment_decides_it_is_refused(tmp_path):
    """One event fails two that compete for an order."""
    tree = load(written(tmp_path, "A pand B C; F fdep T C B", {"B C T": "lambda=1"}))
    with pytest.raises(StructureError, match="fail at one moment, and which of them is first decides"):
        tree.solved(1.0)


def test_too_many_states_are_refused_in_time(tmp_path):
    names = " ".join(f"e{i}" for i in range(40))
    events = {f"e{i}": f"lambda={1 + i}e-3" for i in range(40)}
    begun = time.perf_counter()
    with pytest.raises(StructureError, match="too many states"):
        load(written(tmp_path, f"A pand G H; G 20of40 {names}; H 21of40 {names}", events)).solved(1.0, begun + 1)
    with pytest.raises(StructureError, match="failures of the fastest state"):
        load(written(tmp_path, "A pand G H", {"G H": "lambda=1e6"})).solved(10.0)


WRONG = {
    "has no top event": '"A" and "B";',
    "is not defined": 'toplevel "A"; "A" and "B";',
    "the top event 'Z' is not defined": 'toplevel "Z"; "A" lambda=1;',
    "hangs on itself": 'toplevel "A"; "A" and "B"; "B" or "A";',
    "defined twice": 'toplevel "A"; "A" lambda=1; "A" lambda=2;',
    "said twice": 'toplevel "A"; toplevel "A"; "A" lambda=1;',
    "'xor' is not taken": 'toplevel "A"; "A" xor "B"; "B" lambda=1;',
    "parameters are not taken": 'param x; toplevel "A"; "A" lambda=1;',
    "expected a number": 'toplevel "A"; "A" lambda=x;',
    "expected one that can be": 'toplevel "A"; "A" lambda=-1;',
    "dorm=2": 'toplevel "A"; "A" lambda=1 dorm=2;',
    "'cov=1' is not taken": 'toplevel "A"; "A" lambda=1 cov=1;',
    "expected lambda, lambda and phases": 'toplevel "A"; "A" shape=1;',
    "expected at least one": 'toplevel "A"; "A" 3of2 "B" "C"; "B" lambda=1; "C" lambda=1;',
    "expected basic events": 'toplevel "A"; "A" and "B" "C"; "B" lambda=1; "C" or "B"; "F" fdep "B" "C";',
    "expected 0 … 1": 'toplevel "A"; "A" and "B" "C"; "B" lambda=1; "C" lambda=1; "F" pdep=2 "B" "C";',
    "each once": 'toplevel "A"; "A" wsp "B" "B"; "B" lambda=1;',
    "has no inputs": 'toplevel "A"; "A" and;',
    "expected a semicolon": 'toplevel "A";\n"A" lambda=1',
}


@each_case(("message", "text"), WRONG.items())
def test_what_is_wrong_is_said_in_a_line(tmp_path, message, text):
    path = tmp_path / "tree.dft"
    path.write_text(text)
    with pytest.raises(DesignError, match=message.replace("'", ".")) as caught:
        load(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_comments_lines_and_names(tmp_path):
    path = tmp_path / "tree.dft"
    path.write_text(
        '/* two\nlines */ toplevel System; // the whole\n\nSystem or\n  "first part" B;\n"first part" lambda=1; '
        "B lambda=2;"
    )
    assert load(path).solved(1.0).probability == pytest.approx(1 - math.exp(-3), rel=1e-12)
