"""The report: one page that needs nothing else; the same inputs give the same bytes."""

import re


def test_the_same_design_and_past_give_the_same_bytes(inside, design, recording, tmp_path):
    assert inside("replay", design, recording, "--store", "past.db").returncode in (0, 1)
    for name in ("one.html", "other.html"):
        done = inside("report", design, "--store", "past.db", "--output", name)
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
    assert inside("report", design, "--output", "health.pdf").returncode == 3
