"""The site of the documents has every page, and where each stands is said once."""

from book.pages import GENERATED, ROOT, navigated


def test_every_page_is_in_the_navigation_once() -> None:
    pages = navigated()
    assert len(pages) == len(set(pages))
    written = {path.relative_to(ROOT).as_posix() for path in ROOT.glob("docs/**/*.md")}
    decisions = {name for name in written if name.startswith("docs/adr/0")}  # listed by their own page
    assert (written - decisions) | set(GENERATED) <= set(pages)
    assert [name for name in pages if name not in GENERATED and not (ROOT / name).is_file()] == []
    assert not [name for name in GENERATED if (ROOT / name).exists()], "made at every build, and not kept"
