"""Undo without limit, that outlives the process; the file stays the truth and is written only on purpose."""

import threading
from contextlib import closing
from pathlib import Path

import pytest

from robophm.core.errors import DesignError, StoreError
from robophm.core.yaml_values import values
from robophm.design import editing
from robophm.design.located_error import LocatedError
from robophm.web.workspace import OutsideError, StaleError, Workspace

from .conftest import SMALL

HORN = {"rate": "1 FPMH"}


def put(path, value):
    return lambda document: editing.put(document, path, value)


@pytest.fixture
def path(tmp_path) -> Path:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    return design


def test_every_edit_is_undone_and_done_again_by_another_process(path):
    one = Workspace(path)
    texts = [one.draft().text]
    for i in range(40):
        texts.append(one.edit(one.draft().revision, put(["components", f"horn {i}"], HORN), f"horn {i}").text)
    one.close()
    other = Workspace(path)
    for text in reversed(texts[:-1]):
        assert other.undo(other.draft().revision).text == text
    assert other.draft().text == SMALL
    assert not other.draft().undo
    for text in texts[1:]:
        assert other.redo(other.draft().revision).text == text
    assert path.read_text() == SMALL  # nobody saved


def test_comments_stay_and_only_what_was_meant_changes(path):
    work = Workspace(path)
    draft = work.edit(1, put(["modules", "drive", "components", "motor", "quantity"], 3), "three")
    assert draft.text == SMALL.replace("quantity: 2", "quantity: 3")


def test_a_write_of_an_older_revision_is_refused_and_changes_nothing(path):
    work = Workspace(path)
    now = work.edit(1, put(["components", "horn"], HORN), "horn")
    for write in (work.undo, work.redo, work.save, lambda r: work.edit(r, put(["name"], "x"), ""),
                  lambda r: work.replace(r, SMALL, "")):  # fmt: skip
        with pytest.raises(StaleError, match="revision 2, not 1"):
            write(1)
    assert work.draft() == now


def test_an_edit_that_fails_half_way_leaves_nothing(path):
    work = Workspace(path)

    def half(document):
        editing.put(document, ["components", "horn"], HORN)
        editing.delete(document, ["components", "nothing"])

    with pytest.raises(LocatedError):
        work.edit(1, half, "")
    assert work.draft().text == SMALL
    assert work.edit(1, put(["name"], "other"), "").text == SMALL.replace("courier\n", "other\n")


def test_saving_keeps_what_was_there_and_refuses_what_is_no_design(path):
    work = Workspace(path)
    draft = work.edit(1, put(["components", "horn"], HORN), "horn")
    assert not draft.saved
    assert work.save(draft.revision).saved
    assert path.read_text() == draft.text
    assert path.with_name("courier.yaml.bak").read_text() == SMALL
    broken = work.edit(draft.revision, put(["components", "horn", "rate"], "loud"), "")
    with pytest.raises(DesignError, match="components/horn/rate: 'loud' is not a number with a unit"):
        work.save(broken.revision)
    assert path.read_text() == draft.text
    back = work.undo(broken.revision)
    assert back.saved


def test_a_new_edit_after_undo_keeps_the_other_way_in_the_file(path):
    work = Workspace(path)
    first = work.edit(1, put(["name"], "first"), "first")
    back = work.undo(first.revision)
    second = work.edit(back.revision, put(["name"], "second"), "second")
    assert second.redo is None
    assert work.text(first.state) == first.text  # nothing that ever was is lost


def test_a_file_that_somebody_else_changed_is_one_more_state(path):
    work = Workspace(path)
    mine = work.edit(1, put(["name"], "mine"), "mine")
    work.close()
    path.write_text(SMALL.replace("name: courier", "name: theirs"))
    again = Workspace(path)
    draft = again.draft()
    assert "theirs" in draft.text
    assert draft.saved
    assert draft.what == "changed outside"
    assert again.undo(draft.revision).text == mine.text


def test_a_robot_begins_without_a_file(tmp_path):
    path = tmp_path / "new robot.yaml"
    work = Workspace(path)
    assert work.begun
    assert not work.draft().saved
    with pytest.raises(DesignError, match="not saved"):
        work.save(1)
    assert not path.exists()
    draft = work.edit(1, put(["components", "horn"], HORN), "horn")
    work.save(draft.revision)
    assert path.read_text() == "schema_version: 1\nname: new robot\ncomponents:\n  horn:\n    rate: 1 FPMH\n"
    work.close()
    assert Workspace(path).draft().text == draft.text


def test_threads_take_turns(path):
    work = Workspace(path)
    done = []

    def add(name):
        while True:
            try:
                done.append(work.edit(work.draft().revision, put(["components", name], HORN), name))
                return
            except StaleError:
                continue

    threads = [threading.Thread(target=add, args=(f"horn {i}",)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(draft.revision for draft in done) == list(range(2, 10))
    assert all(f"horn {i}" in work.draft().text for i in range(8))


def test_what_is_no_file_of_edits_is_left_alone(path):
    path.with_name("courier.yaml.edits").write_text("something else")
    with pytest.raises(StoreError, match=r"expected the edits of courier\.yaml"):
        Workspace(path)
    assert path.with_name("courier.yaml.edits").read_text() == "something else"
    with pytest.raises(DesignError, match="no such folder"):
        Workspace(path.parent / "nowhere" / "robot.yaml")


def test_a_design_for_which_there_are_no_figures_is_no_design_without_problems(path):
    """Three parts that age share a load: the robot can be drawn and saved, but nothing computed."""
    pump = "pump: {rate: 1e-3 /h, quantity: 3, life: {distribution: weibull, shape: 2}}"
    path.write_text(f"schema_version: 1\nname: R\ncomponents: {{{pump}}}\n"
                    "diagram: {load_sharing: {of: [pump], exponent: 2}}\n")  # fmt: skip
    work = Workspace(path)
    checked = work.checked.of(work.draft().text)
    (problem,) = checked.problems
    assert problem.level == "error"
    assert "no exact solution" in problem.message
    assert checked.robot is not None


def test_a_file_edited_by_hand_meanwhile_is_not_written_over(path):
    work = Workspace(path)
    mine = work.edit(1, put(["components", "horn"], HORN), "horn")
    by_hand = SMALL.replace("quantity: 2", "quantity: 4")
    path.write_text(by_hand)
    with pytest.raises(OutsideError, match=r"courier\.yaml was changed outside since it was read") as caught:
        work.save(mine.revision)
    assert path.read_text() == by_hand
    before, after = (line for line in caught.value.changes[2:] if line[:1] in "+-")
    assert ("quantity: 2" in before, "quantity: 4" in after) == (True, True)
    # It is changed once more: what was seen is not what would be lost.
    path.write_text(by_hand.replace("4", "5"))
    with pytest.raises(OutsideError) as again:
        work.save(mine.revision, caught.value.digest)
    assert work.save(mine.revision, again.value.digest).saved
    assert path.read_text() == mine.text
    assert path.with_name("courier.yaml.bak").read_text() == by_hand.replace("4", "5")
    # The next save takes its backup not away.
    more = work.edit(mine.revision, put(["components", "bell"], HORN), "bell")
    work.save(more.revision)
    assert path.with_name("courier.yaml.bak.2").read_text() == by_hand.replace("4", "5")


def test_what_was_made_of_it_by_hand_is_taken_and_ones_own_comes_back_by_undo(path):
    work = Workspace(path)
    mine = work.edit(1, put(["components", "horn"], HORN), "horn")
    work.save(mine.revision)
    mine = work.edit(mine.revision, put(["components", "bell"], HORN), "bell")
    by_hand = SMALL.replace("quantity: 2", "quantity: 4")
    path.write_text(by_hand)
    taken = work.take(mine.revision)
    assert (taken.text, taken.saved, taken.what) == (by_hand, True, "changed outside")
    back = work.undo(taken.revision)
    assert (back.text, back.saved) == (mine.text, False)
    assert work.save(back.revision).saved
    with pytest.raises(StaleError):
        work.take(1)


def test_a_design_that_its_file_no_longer_holds_is_not_saved(path):
    work = Workspace(path)
    assert work.draft().saved
    path.write_text(SMALL.replace("quantity: 2", "quantity: 4"))
    assert not work.draft().saved
    path.write_text(SMALL)
    assert work.draft().saved
    path.unlink()
    assert not work.draft().saved
    assert work.save(work.draft().revision).saved  # nothing is there to be lost
    assert path.read_text() == SMALL


def test_a_file_that_appears_where_a_robot_was_begun_is_not_written_over(tmp_path):
    path = tmp_path / "new.yaml"
    work = Workspace(path)
    draft = work.edit(1, put(["components", "horn"], HORN), "horn")
    path.write_text(SMALL)
    with pytest.raises(OutsideError):
        work.save(draft.revision)
    assert path.read_text() == SMALL


def test_a_file_that_is_no_design_is_not_taken(path):
    work = Workspace(path)
    path.write_text("{")
    with pytest.raises(LocatedError):
        work.take(1)
    assert work.draft().text == SMALL


def test_an_edit_is_taken_back_alone_and_done_again_and_what_others_made_since_stays(path):
    work = Workspace(path)
    mine = work.edit(1, put(["components", "horn"], HORN), "horn")
    theirs = work.edit(mine.revision, put(["modules", "drive", "components", "motor", "quantity"], 3), "three")
    back = work.undo(theirs.revision, mine.state)
    assert back.text == SMALL.replace("quantity: 2", "quantity: 3")
    assert back.what == "undo: horn"
    again = work.redo(back.revision, mine.state)
    assert "horn" in again.text
    assert "quantity: 3" in again.text
    assert work.undo(again.revision, theirs.state).text == mine.text


def test_an_edit_that_another_has_touched_is_not_taken_back_and_that_is_said(path):
    work = Workspace(path)
    mine = work.edit(1, put(["components", "horn"], HORN), "horn")
    theirs = work.edit(mine.revision, put(["components", "horn", "rate"], "2 FPMH"), "louder")
    with pytest.raises(LocatedError, match="changed since by another edit"):
        work.undo(theirs.revision, mine.state)
    assert work.draft() == theirs
    with pytest.raises(DesignError, match="no state 99"):
        work.undo(theirs.revision, 99)


def test_a_file_that_was_changed_by_hand_is_taken_in_where_nothing_is_lost_by_it(path):
    work = Workspace(path)
    assert not work.follow_file()
    path.write_text(SMALL.replace("name: courier", "name: express"))
    assert not work.follow_file()
    assert "courier" in work.draft().text  # another look: it may still be being written
    assert not work.follow_file()
    taken = work.draft()
    assert ("express" in taken.text, taken.saved, taken.what) == (True, True, "changed outside")
    assert work.revision == taken.revision == 2
    assert work.undo(taken.revision).text == SMALL


@pytest.mark.parametrize("of_hand", [SMALL.replace("name: courier", "name: express"), "name: [", ""])
def test_a_file_changed_by_hand_is_left_where_edits_would_be_lost(path, of_hand):
    work = Workspace(path)
    draft = work.edit(1, put(["components", "horn"], HORN), "horn")
    path.write_text(of_hand)
    assert [work.follow_file() for _ in range(3)] == [True] * 3
    assert work.draft().text == draft.text
    path.write_text(draft.text)
    assert not work.follow_file()
    assert work.draft().saved


def test_a_file_that_is_no_design_is_left(path):
    work = Workspace(path)
    path.write_text("name: [")
    assert [work.follow_file() for _ in range(3)] == [True] * 3
    assert work.draft().text == SMALL


def test_histories_are_told_apart(path):
    one = Workspace(path)
    number = one.history
    one.close()
    assert Workspace(path).history == number
    path.with_name("courier.yaml.edits").unlink()
    for log in path.parent.glob("*.edits-*"):
        log.unlink()
    assert Workspace(path).history != number


def test_a_value_is_put_into_the_text_as_it_is_written(tmp_path):
    """Its own spaces, quotes and remarks stay; an edit of what is around it afterwards knows the new value."""
    design = tmp_path / "courier.yaml"
    text = SMALL.replace("lidar: {rate: 30 FPMH}", "lidar:   { rate:   30 FPMH }     # 'by its maker'")
    design.write_text(text)
    with closing(Workspace(design)) as work:
        place = ["modules", "see", "components", "lidar", "rate"]

        def rate(revision, value):
            return work.edit(revision, put(place, value), "rate", (place, value))

        draft = rate(1, "31 FIT")
        assert draft.text == text.replace("30 FPMH", "31 FIT")
        assert work.undo(draft.revision).text == text
        assert work.edit(3, put(place, "3 FIT"), "rate").text != text.replace("30 FPMH", "3 FIT")  # as YAML is written
        assert work.undo(4).text == text
        comma = rate(5, "31 FIT, more")  # which would end there, within braces
        assert values(comma.text, "x")[0]["modules"]["see"]["components"]["lidar"] == {"rate": "31 FIT, more"}
        assert work.undo(6).text == text
        work.edit(7, put(["components", "horn", "rate"], "1 FIT"), "a horn")
        quick = rate(8, "32 FIT")
        later = work.edit(9, lambda document: editing.delete(document, ["components", "horn"]), "no horn")
        assert values(quick.text, "x")[0]["modules"] == values(later.text, "x")[0]["modules"]
        assert later.text.count("32 FIT") == 1
        with pytest.raises(StaleError):
            rate(9, "1 FIT")
