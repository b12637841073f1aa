"""CUDD beside the sum over all states, in a process that can be ended; skipped where it is not installed."""

import math
import os
import random
import time
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from robophm.blocks import by_cudd
from robophm.blocks.by_cudd import available, compiled_by_cudd
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ALL, ANY, NOT, ODD, UNIT, Gate
from robophm.blocks.nodes import FALSE, TRUE, TooLargeError, below, node_chances

pytestmark = pytest.mark.skipif(not available(), reason="no dd with CUDD (pip install robophm[bdd])")


def true(gates, states):
    """The value of the last gate, by its definition."""
    values = list(states)
    for k, inputs in gates:
        count = sum(values[i] for i in inputs)
        values.append(
            {NOT: count == 0, ODD: count % 2 == 1, ALL: count == len(inputs), ANY: count > 0}.get(k, count >= k)
        )
    return values[-1]


def every_kind(rng, n, gates):
    """A random structure of n variables in which gates of every kind follow one another."""
    found = []
    for i in range(gates):
        k = rng.choice([ALL, ANY, NOT, ODD, 2])
        inputs = rng.sample(range(n + i), 1 if k == NOT else rng.randint(2, min(5, n + i)))
        found.append((k, inputs))
    return [*found, (ODD, [n + gates - 1, n + gates - 2])]


@pytest.mark.parametrize("seed", range(3))
def test_every_kind_of_gate_is_as_the_sum_over_all_states(seed):
    rng = random.Random(seed)
    n = 8
    gates = every_kind(rng, n, 30)
    p = [rng.random() for _ in range(n)]
    exact = math.fsum(
        math.prod(q if s else 1 - q for q, s in zip(p, states, strict=True))
        for states in product((False, True), repeat=n)
        if true(gates, states)
    )
    table, order, (root,) = compiled_by_cudd(n, gates, 10_000, time.perf_counter() + 60)
    chances = node_chances(table, below(table, root), [p[x] for x in order])
    assert chances[root] == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize(("k", "leaf"), [(ALL, FALSE), (ANY, TRUE)])
def test_what_is_never_or_always_true_is_a_leaf(k, leaf):
    _, _, (root,) = compiled_by_cudd(1, [(NOT, [0]), (k, [0, 1])], 10, time.perf_counter() + 60)
    assert root == leaf


def test_no_module_of_the_folder_that_it_is_run_in_is_imported(tmp_path, monkeypatch):
    (tmp_path / "json.py").write_text("raise SystemExit('imported')")
    monkeypatch.chdir(tmp_path)
    table, _, (root,) = compiled_by_cudd(2, [(ALL, [0, 1])], 10, time.perf_counter() + 60)
    assert len(below(table, root)) == 2


def middle(n):
    """The product of two n-digit numbers in its middle digit: no order keeps its diagram small (Bryant 1991)."""
    gates = []

    def add(k, *inputs):
        gates.append((k, list(inputs)))
        return 2 * n + len(gates) - 1

    columns = [[] for _ in range(2 * n)]
    for i, j in product(range(n), repeat=2):
        columns[i + j].append(add(ALL, i, n + j))
    for i in range(n):
        while len(columns[i]) > 1:
            three = columns[i][:3]
            columns[i] = [*columns[i][3:], add(ODD, *three)]
            columns[i + 1].append(add(2, *three))
    gates.append((ANY, [columns[n - 1][0], columns[n - 1][0]]))
    return gates


def ours(cmdline):
    """Whether a process is a child of this one."""
    return int(cmdline.with_name("stat").read_text().rpartition(")")[2].split()[1]) == os.getpid()


def test_what_takes_too_long_is_ended_and_no_process_is_left():
    begun = time.perf_counter()
    with pytest.raises(TooLargeError):
        compiled_by_cudd(60, middle(30), 1_000_000, begun + 3)
    assert time.perf_counter() - begun < 10
    assert not [one for one in Path("/proc").glob("[0-9]*/cmdline") if "cudd_process" in one.read_text() and ours(one)]
    with pytest.raises(TooLargeError):
        compiled_by_cudd(4, middle(2), 1_000, time.perf_counter())


def test_what_takes_too_much_memory_or_too_many_nodes_is_refused(monkeypatch):
    with pytest.raises(TooLargeError):
        compiled_by_cudd(12, middle(6), 20, time.perf_counter() + 60)
    monkeypatch.setattr(by_cudd, "MOST_BYTES", 1 << 20)
    with pytest.raises(TooLargeError):
        compiled_by_cudd(4, middle(2), 1_000, time.perf_counter() + 60)


def test_a_tree_that_is_too_large_for_our_own_table_is_left_to_it(monkeypatch):
    n = 7
    gates = middle(n)
    tree = FaultTree([str(i) for i in range(2 * n)], [Gate(UNIT, ())] * (2 * n) + [Gate(*gate) for gate in gates])
    half = np.full(2 * n, 0.5)
    own = tree.probability(half)
    ones = sum(a * b >> n - 1 & 1 for a, b in product(range(2**n), repeat=2))
    assert own == pytest.approx(ones / 4**n, rel=1e-12)
    monkeypatch.setattr("robophm.blocks.modular.compiled", too_large)
    by_it = FaultTree(tree.names, tree.gates)
    with pytest.raises(TooLargeError):
        by_it.probability(half)  # nobody said how long it may take
    by_it = FaultTree(tree.names, tree.gates)
    by_it.solved(time.perf_counter() + 60)
    assert by_it.probability(half) == pytest.approx(ones / 4**n, rel=1e-12)
    assert by_it.modular.size > n


def too_large(*_):
    raise TooLargeError("too many")
