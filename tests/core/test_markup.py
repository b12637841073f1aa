"""XML that a parser would unfold to more memory than there is."""

import pytest

from robophm.core import markup
from robophm.core.errors import DesignError
from robophm.core.markup import Markup


def read(path, text):
    path.write_text(text)
    return Markup(path).root()


def test_attributes_that_are_declared_are_refused(tmp_path):
    """A default of a megabyte, in ten thousand elements, is ten gigabytes."""
    bomb = f"<!DOCTYPE l [\n<!ATTLIST a b CDATA '{'x' * 1000}'>]><l>{'<a/>' * 10}</l>"
    with pytest.raises(DesignError, match=r"bomb\.xml:2: declares attributes of 'a'; none are taken"):
        read(tmp_path / "bomb.xml", bomb)
    assert len(read(tmp_path / "sound.xml", "<!DOCTYPE l><l><a b='1'/></l>").children) == 1


def test_attributes_count_as_elements_do(tmp_path, monkeypatch):
    monkeypatch.setattr(markup, "MAX_ELEMENTS", 100)
    attributes = " ".join(f"a{i}='1'" for i in range(99))
    assert len(read(tmp_path / "sound.xml", f"<l {attributes}/>").attributes) == 99
    with pytest.raises(DesignError, match=r"large\.xml:1: more than 100 elements and attributes"):
        read(tmp_path / "large.xml", f"<l {attributes} more='1'/>")


@pytest.mark.parametrize("tag", ["<l {attributes}/>", "<l><!-- {attributes} --></l>", "<l><?p {attributes}?></l>"])
def test_a_tag_that_goes_on_and_on_is_refused_before_its_attributes_are_made(tmp_path, monkeypatch, tag):
    monkeypatch.setattr(markup, "MAX_TAG", 100_000)
    many = tag.format(attributes=" ".join(f"a{i}='1'" for i in range(50_000)))
    with pytest.raises(DesignError, match=r"large\.xml:1: a tag or comment has more than 100,000 bytes"):
        read(tmp_path / "large.xml", many)
    text = "x" * 300_000  # which is no tag
    assert read(tmp_path / "sound.xml", f"<l>{text}<![CDATA[{text}]]><a b='{text[:90_000]}'/></l>").content == 2 * text
