"""Files, functions and classes stay small enough to be read at once."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

FILE, FUNCTION, CLASS = 450, 60, 12
"""Lines of a file; lines of a function with code in them, docstring and signature not counted; public methods of a
class, properties not counted."""

ALLOWED = {
    "src/robophm/life/distribution.py: class LifeDistribution: 17": "all functions of a life distribution, as in SciPy",
    "src/robophm/transports/recordings/columns/chunked.py: class ChunkedFile: 15": "what a format in chunks tells",
}
GENERATED = ("schema.ts",)  # from the service's description


def python_files():
    return [path for room in ("src", "tests", "benchmarks", "tools") for path in sorted((ROOT / room).rglob("*.py"))]


def code_lines(function, lines):
    """Lines of a function's body that are neither blank nor comments nor its docstring."""
    body = function.body[1:] if ast.get_docstring(function) is not None else function.body
    if not body:
        return 0
    inside = (line.strip() for line in lines[body[0].lineno - 1 : function.end_lineno])
    return sum(bool(line) and not line.startswith("#") for line in inside)


def public_methods(found):
    """Methods that are neither private nor properties."""
    methods = (node for node in found.body if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef))
    plain = (one for one in methods if not any("property" in ast.unparse(mark) for mark in one.decorator_list))
    return [one.name for one in plain if not one.name.startswith("_")]


def too_large(text):
    """What of a file of Python is above its size, in words."""
    lines = text.splitlines()
    found = [str(len(lines))] if len(lines) > FILE else []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and (count := code_lines(node, lines)) > FUNCTION:
            found.append(f"function {node.name}: {count}")
        if isinstance(node, ast.ClassDef) and (count := len(public_methods(node))) > CLASS:
            found.append(f"class {node.name}: {count}")
    return found


def test_files_functions_and_classes_are_small():
    found = {
        f"{path.relative_to(ROOT)}: {one}" for path in python_files() for one in too_large(path.read_text("utf-8"))
    }
    for path in [*(ROOT / "ui/src").rglob("*.ts"), *(ROOT / "ui/src").rglob("*.tsx")]:
        if path.name not in GENERATED and (count := len(path.read_text("utf-8").splitlines())) > FILE:
            found.add(f"{path.relative_to(ROOT)}: {count}")
    assert found == set(ALLOWED)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x = 1\n" * 451, ["451"]),
        ("def f():\n" + '    """Doc."""\n' + "    x = 1\n" * 61, ["function f: 61"]),
        ("def f():\n" + '    """Doc."""\n' + "    x = 1\n\n    # why\n" * 60, []),
        ("class C:\n" + "".join(f"    def m{k}(self): ...\n" for k in range(13)), ["class C: 13"]),
        ("class C:\n" + "".join(f"    @property\n    def m{k}(self): ...\n" for k in range(13)), []),
        ("class C:\n" + "".join(f"    def _m{k}(self): ...\n" for k in range(13)), []),
    ],
)
def test_what_is_too_large_is_found(text, expected):
    assert too_large(text) == expected
