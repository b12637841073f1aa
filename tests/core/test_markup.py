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
