"""What a body may be at each address, and what large ones cost."""

from __future__ import annotations

import asyncio
import json
import random
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from starlette.exceptions import HTTPException

from robophm.web import bounded_bodies
from robophm.web.app import routers
from robophm.web.bounded_bodies import LARGER, LOGIN, MOST_BUT_WORDS, MOST_BYTES, BoundedBodies, Words

from ..transports.listener import within
from .conftest import ROOT, SMALL, Served, serving

JSON = {"content-type": "application/json"}


def test_what_is_larger_is_larger_at_addresses_that_there_are() -> None:
    paths = {getattr(route, "path", "") for router in routers() for route in router.routes}
    assert {*LARGER, LOGIN} <= paths


def beside_words(text: str) -> int:
    """Letter by letter: all outside quotes, and one for each quoted word."""
    count, inside, escaped = 0, False, False
    for letter in text:
        if inside and (escaped or letter == "\\"):
            escaped = not escaped
        elif letter == '"':
            count += not inside
            inside = not inside
        else:
            count += not inside
    return count


def test_words_are_told_from_the_rest_wherever_a_body_is_cut() -> None:
    draw = random.Random(3)
    letters = ['"', "\\", "a", "\n", "\u00e9", ",", "[", "\\\\"]
    for _ in range(300):
        value = ["".join(draw.choices(letters, k=draw.randrange(6))) for _ in range(5)]
        text = json.dumps({"a": value, "b": [1.5, None, {}], value[0]: []}, ensure_ascii=False)
        body, words, found, at = text.encode(), Words(), 0, 0
        while at < len(body):
            step = draw.randrange(1, 9)
            found = words.beside(body[at : at + step])
            at += step
        assert found == beside_words(text), text


@pytest.mark.parametrize("value", ["[],", '{"":0},', '"",', "1,", '{"a":{"b":[]}},'])
def test_many_values_are_refused_whatever_they_are(shared_small: Served, value: str) -> None:
    body = '{"text":[' + value * (5_000_000 // len(value)) + "1]}"
    answer = shared_small.client.post("/api/design/check", content=body, headers=JSON)
    assert answer.status_code == 413
    assert answer.json()["message"].endswith("expected fewer values")


def test_where_no_text_comes_a_body_is_small(shared_small: Served) -> None:
    """A rate is asked by a viewer."""
    body = b'{"text":"' + b" " * MOST_BYTES + b'"}'
    for path in ("/api/library/rate", "/api/what-if", "/api/sensors/test"):
        assert shared_small.client.post(path, content=body, headers=JSON).status_code in (404, 413)
    said = shared_small.client.post("/api/library/rate", content=body, headers=JSON)
    assert (said.status_code, said.json()["message"]) == (413, "the request is larger than 1 MB")
    said = shared_small.client.post("/api/library/rate", content=iter([body]), headers=JSON)  # which says no length
    assert (said.status_code, said.json()["message"]) == (413, "the request is larger than 1 MB")


def test_a_text_of_a_large_design_is_taken(shared_small: Served) -> None:
    """20 MB of it, all but one line remarks, and letters beyond ASCII among them."""
    text = "schema_version: 1\nname: large\ncomponents: {a: {rate: 1 FPMH}}\n" + "# é words\n" * 1_700_000
    answer = shared_small.client.post("/api/design/check", json={"text": text})
    assert (answer.status_code, answer.json()) == (200, {"problems": []})


def test_large_bodies_take_turns_and_few_may_wait(small: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    texts = [f"schema_version: 1\nname: r{i}\ncomponents: {{a: {{rate: 1 FPMH}}}}\n" for i in range(3)]
    size = len(small.client.build_request("POST", "/", json={"text": texts[0]}).content)
    monkeypatch.setattr(bounded_bodies, "LARGE", size - 1)
    monkeypatch.setattr(bounded_bodies, "MOST_WAITING", 2 * size)
    checked = small.service.workspace.checked
    begun, going, found = [], threading.Event(), []

    def slow(text: str) -> tuple[()]:
        if text not in texts:  # of the design itself, which is read ahead
            return ()
        begun.append(text)
        assert going.wait(60)
        return ()

    monkeypatch.setattr(checked, "problems", slow)

    def ask(text: str) -> None:
        found.append(small.client.post("/api/design/check", json={"text": text}).status_code)

    threads = [threading.Thread(target=ask, args=(text,)) for text in texts]
    try:
        for thread in threads:
            thread.start()
        within(30, lambda: found == [503])  # whichever came last
        within(30, lambda: len(begun) == 1)
        assert small.get("/api/design/schema")  # what is small is answered meanwhile
    finally:
        going.set()
        for thread in threads:
            thread.join(30)
    assert sorted(found) == [200, 200, 503]
    small.post("/api/design/check", {"text": texts[0]})  # all turns have ended


MEASURED = """
import socket, sys, threading
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from tests.web.conftest import SMALL, serving

def peak():
    return int(Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0]) // 1024

path = Path(sys.argv[2])
path.write_text(SMALL)
values = b'{"text":[' + b"[]," * 7_000_000 + b"1]}"
text = b'{"text":"' + b"# word\\\\n" * 2_500_000 + b'"}'
with serving(path) as served:
    def ask(body):
        host = served.address.split("/")[2]
        head = f"POST /api/design/check HTTP/1.1\\r\\nHost: {host}\\r\\nContent-Type: application/json\\r\\n"
        with socket.create_connection(("127.0.0.1", int(host.split(":")[1])), timeout=60) as there:
            try:
                there.sendall(f"{head}Content-Length: {len(body)}\\r\\nConnection: close\\r\\n\\r\\n".encode())
                there.sendall(body)
                while there.recv(65536): pass
            except OSError:
                pass  # it was refused before all of it had come
    for body in (values, text):
        before = peak()
        threads = [threading.Thread(target=ask, args=(body,)) for _ in range(6)]
        for thread in threads: thread.start()
        for thread in threads: thread.join()
        print(peak() - before)
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs the peak of a process")
@pytest.mark.full
def test_several_large_bodies_at_once_do_not_fill_the_memory(tmp_path: Path) -> None:
    """Without bounds six bodies of values took 800 MB, and six texts of a million lines 3.4 GB."""
    words = [sys.executable, "-c", MEASURED, str(ROOT), str(tmp_path / "robot.yaml")]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120, check=True)
    of_values, of_texts = map(int, done.stdout.split())
    assert of_values < 100
    assert of_texts < 300


def test_a_value_of_as_many_numbers_as_one_edit_may_have_is_let_through() -> None:
    """12 letters each, as they are written at full length."""
    assert Words().beside(json.dumps([0.123456789012] * 100_000).encode()) < MOST_BUT_WORDS


def test_who_may_only_look_sends_little_and_keeps_nobody_waiting(tmp_path: Path) -> None:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    bodies = BoundedBodies()

    async def two_of_viewers() -> list[bool]:
        """Whether an editor, and a third viewer, may wait behind two viewers."""
        ahead = [asyncio.create_task(bodies.wait(1_000_000, "viewer")) for _ in range(2)]
        await asyncio.sleep(0)
        with pytest.raises(HTTPException) as refused:
            await bodies.wait(200_000, "viewer")
        assert refused.value.status_code == 503
        editor = asyncio.create_task(bodies.wait(20_000_000, "editor"))
        await asyncio.sleep(0)
        for one in (*ahead, editor):
            await one
            bodies.go_on(20_000_000 if one is editor else 1_000_000, "editor" if one is editor else "viewer")
        await bodies.wait(1_000_000, "viewer")
        return [True]

    with ThreadPoolExecutor(1) as elsewhere:  # another test in this process may have a loop that runs
        assert elsewhere.submit(asyncio.run, two_of_viewers()).result()
    with serving(design) as served:
        tokens = {role: served.service.visitors.users.add_token(role, role) for role in ("viewer", "editor")}
        text = "schema_version: 1\nname: large\ncomponents: {a: {rate: 1 FPMH}}\n" + "# word\n" * 200_000
        said = {
            role: served.client.post(
                "/api/design/check", json={"text": text}, headers={"authorization": f"Bearer {token}"}
            ).status_code
            for role, token in tokens.items()
        }
        assert said == {"viewer": 413, "editor": 200}


def test_a_place_of_a_large_design_is_not_written_by_itself(tmp_path: Path) -> None:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as served:
        state = served.client.get("/api/design/part", params={"path": "name"}).json()
        assert state["text"].strip() in SMALL
        large = SMALL + "# word\n" * 200_000
        body = {"revision": state["revision"], "text": large}
        assert served.client.put("/api/design/text", json=body).status_code == 200
        said = served.client.get("/api/design/part", params={"path": "name"})
        assert said.status_code == 422
        assert "more than 1 MB is not written by its places" in said.json()["message"]
        assert served.client.get("/api/design/part").json()["text"] == large
