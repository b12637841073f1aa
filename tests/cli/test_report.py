"""The report: one page that needs nothing else; the same inputs give the same bytes."""

import hashlib
import json
import re
import sys
from importlib.metadata import version

import pytest

import robophm
from robophm.report.page import page, section


def test_the_same_design_and_past_give_the_same_bytes(inside, design, recording, tmp_path):
    assert inside("replay", design, recording, "--store", "past.db").returncode in (0, 1)
    for name in ("one.html", "other.html"):
        done = inside("report", design, "--store", "past.db", "--to", name)
        assert done.returncode in (0, 1), done.stderr
    page = (tmp_path / "one.html").read_bytes()
    assert page == (tmp_path / "other.html").read_bytes()
    text = page.decode()
    assert "<script" not in text
    assert not re.search(r'(?:src|href)="', text)
    assert "How it is wired" in text


def test_a_page_that_is_there_is_replaced_only_on_purpose(inside, design, tmp_path):
    (tmp_path / "health.html").write_text("mine")
    refused = inside("report", design)
    assert refused.returncode == 3
    assert "exists" in refused.stderr
    assert (tmp_path / "health.html").read_text() == "mine"
    assert inside("report", design, "--force").returncode in (0, 1)
    assert inside("report", design, "--to", "health.pdf").returncode == 3


def test_it_says_which_design_and_which_data_it_is_made_of(inside, run, design, recording, tmp_path):
    assert inside("replay", design, recording, "--store", "past.db", "--report", "replayed.html").returncode in (0, 1)
    for options in (("--to", "design.html"), ("--store", "past.db", "--to", "lived.html")):
        assert inside("report", design, *options).returncode in (0, 1)
    replayed, alone, lived = (hashes(tmp_path / f"{name}.html") for name in ("replayed", "design", "lived"))
    robot = robophm.load(design)
    with robophm.open_store(tmp_path / "past.db") as store:
        past = [store.ledger(robot.identity), store.history(robot.identity).figures().to_json()]
    content = json.dumps(past, sort_keys=True, separators=(",", ":"))
    assert lived == replayed == [robot.design_hash, hashlib.sha256(content.encode()).hexdigest()]
    assert alone == lived[:1]
    text = (tmp_path / "lived.html").read_text()
    assert f"numpy {version('numpy')}" in text
    assert "none: as designed" in (tmp_path / "design.html").read_text()


def hashes(page):
    return re.findall(r"\b[0-9a-f]{64}\b", page.read_text())


def test_a_pdf_has_numbers_of_pages_and_its_headings_as_bookmarks():
    weasyprint = pytest.importorskip("weasyprint", exc_type=Exception, reason="no WeasyPrint, or no Pango")
    body = [section(title, *[f"line {i}" for i in range(60)]) for title in ("Why", "Curves")]
    made = weasyprint.HTML(string=page("Health", body)).render()
    texts = [box.text for one in made.pages for box in one._page_box.descendants() if hasattr(box, "text")]
    n = len(made.pages)
    assert n > 1
    assert [one for one in texts if " / " in one] == [f"{i} / {n}" for i in range(1, n + 1)]
    assert [mark[1] for one in made.pages for mark in one.bookmarks] == ["Health", "Why", "Curves"]


@pytest.mark.full
def test_a_pdf_is_the_same_bytes_in_another_process(inside, run, tmp_path):
    pytest.importorskip("weasyprint", exc_type=Exception, reason="no WeasyPrint, or no Pango")
    design = tmp_path / "robot.yaml"
    design.write_text("schema_version: 1\nname: R\ncomponents: {motor: {rate: 8 FPMH}, fan: {rate: 2 FPMH}}\n")
    assert inside("report", design, "--pdf").returncode in (0, 1)
    other = run("report", design, "--pdf", "--to", "other.pdf")
    assert other.returncode in (0, 1), other.stderr
    made = (tmp_path / "health.pdf").read_bytes()
    assert made[:5] == b"%PDF-"
    assert made == (tmp_path / "other.pdf").read_bytes()


@pytest.mark.parametrize(
    ("weasyprint", "advice"),
    [
        (
            "raise ModuleNotFoundError(\"No module named 'weasyprint'\", name='weasyprint')",
            "pip install 'robophm[pdf]'",
        ),
        (
            "raise OSError(\"cannot load library 'libpango-1.0-0': none. See the docs\")",
            "apt-get install libpango-1.0-0",
        ),
    ],
)
def test_where_a_pdf_cannot_be_made_one_line_says_what_to_install(
    inside, design, tmp_path, weasyprint, advice, monkeypatch
):
    """In the place of WeasyPrint what raises as it does where it, or Pango, is not installed."""
    (tmp_path / "lacking").mkdir()
    (tmp_path / "lacking" / "weasyprint.py").write_text(f"print('much advice')\n{weasyprint}\n")
    monkeypatch.syspath_prepend(tmp_path / "lacking")
    monkeypatch.delitem(sys.modules, "weasyprint", raising=False)
    done = inside("report", design, "--pdf")
    assert done.returncode == 3
    assert advice in done.stderr
    assert done.stdout == ""
    assert len(done.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "health.pdf").exists()
