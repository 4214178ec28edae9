"""The editor's server: tells this machine's browser of the editor and one shape, and nobody of anything else."""

from __future__ import annotations

import contextlib
import html
import http.client
import json
import os
import re
import socket
import threading
import time
import urllib.parse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import neuralmls.editor_server.server as module
from neuralmls.editor_server import EditorServer, Session
from neuralmls.editor_server.connections import MOST
from neuralmls.editor_server.folder import File
from neuralmls.errors import ArgumentError, FileError


@pytest.fixture
def static(tmp_path: Path) -> Path:
    """A folder as a build leaves it."""
    folder = tmp_path / "static"
    (folder / "assets").mkdir(parents=True)
    (folder / "index.html").write_text("<title>the editor</title>")
    (folder / "content-security-policy.txt").write_text("default-src 'none'; script-src 'self'")
    (folder / "assets" / "core.wasm").write_bytes(b"\0asm")
    (folder / "assets" / "main.js").write_text("1")
    return folder


@pytest.fixture
def session(tmp_path: Path) -> Session:
    """A shape with a material in a subfolder, control points, and a file beside them that is nobody's business."""
    (tmp_path / "mine").mkdir()
    (tmp_path / "chair.obj").write_text("v 0 0 0\n")
    (tmp_path / "mine" / "oak.mtl").write_text("newmtl oak\n")
    (tmp_path / "points.json").write_text("{}")
    (tmp_path / "secret.txt").write_text("secret")
    return Session(tmp_path / "chair.obj", {"mine/oak.mtl": tmp_path / "mine" / "oak.mtl"}, tmp_path / "points.json")


@contextmanager
def running(session: Session | None, static: Path, **options: int) -> Iterator[EditorServer]:
    with EditorServer(session, static=static, **options) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


@pytest.fixture
def server(session: Session, static: Path) -> Iterator[EditorServer]:
    with running(session, static) as server:
        yield server


def ask(server: EditorServer, path: str, method: str = "GET", **headers: str) -> tuple[int, dict[str, str], bytes]:
    """Ask for a path below the server's own address."""
    return ask_exactly(server, f"/{server.token}{path}", method, **headers)


def ask_exactly(
    server: EditorServer, path: str, method: str = "GET", **headers: str
) -> tuple[int, dict[str, str], bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=10)
    try:
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, path, headers=named)
        response = connection.getresponse()
        return response.status, dict(response.getheaders()), response.read()
    finally:
        connection.close()


def test_the_editor_and_the_session_are_served_with_their_types(server, session):
    assert ask(server, "/")[2] == b"<title>the editor</title>"
    assert ask(server, "/?session")[0] == 200
    for path, kind in [
        ("/", "text/html; charset=utf-8"),
        ("/assets/main.js", "text/javascript; charset=utf-8"),
        ("/assets/core.wasm", "application/wasm"),
    ]:
        assert ask(server, path)[1]["Content-Type"] == kind
    listed = json.loads(ask(server, "/session.json")[2])
    assert listed["shape"] == "chair.obj"
    served = {file["name"]: ask(server, "/" + file["address"])[2] for file in listed["files"]}
    assert served == {"chair.obj": b"v 0 0 0\n", "mine/oak.mtl": b"newmtl oak\n"}
    assert listed["points"]["name"] == "points.json"
    assert ask(server, "/" + listed["points"]["address"])[2] == b"{}"
    assert server.url.endswith(f"/{server.token}/?session")


@pytest.mark.parametrize(
    "path",
    [
        "/secret.txt",
        "/../secret.txt",
        "/session/../secret.txt",
        "/session/..%2fsecret.txt",
        "/%2e%2e/secret.txt",
        "//etc/passwd",
        "/session/2",
        "/session/",
        "/assets",
        "/assets/",
        "/chair.obj",
    ],
)
def test_nothing_else_is_served(server, path):
    status, _, body = ask(server, path)
    assert status in {400, 404}
    assert b"secret" not in body
    assert b"root:" not in body


def test_without_a_session_there_is_no_session(static):
    with running(None, static) as server:
        assert ask(server, "/session.json")[0] == 404
        assert "session" not in server.url


@pytest.mark.parametrize(
    "host", ["example.org", "example.org:{port}", "127.0.0.1", "127.0.0.1:1", "localhost.example.org:{port}", ""]
)
def test_requests_under_another_name_are_refused(server, host):
    status, _, body = ask(server, "/session/0", Host=host.format(port=server.server_port))
    assert status == 403
    assert b"v 0" not in body


def test_a_request_that_names_two_hosts_or_none_is_refused(server):
    own = f"Host: 127.0.0.1:{server.server_port}\r\n"
    for hosts in ["", own + "Host: example.org\r\n"]:
        with socket.create_connection(("127.0.0.1", server.server_port), timeout=10) as raw:
            raw.sendall(f"GET /{server.token}/session/0 HTTP/1.1\r\n{hosts}Connection: close\r\n\r\n".encode())
            with raw.makefile("rb") as stream:
                assert b" 403 " in stream.readline()


@pytest.mark.parametrize("origin", ["https://example.org", "null", "http://127.0.0.1:1", "file://"])
def test_requests_of_other_pages_are_refused(server, origin):
    assert ask(server, "/session/0", Origin=origin)[0] == 403
    assert ask(server, "/session/0", Origin=f"http://127.0.0.1:{server.server_port}")[0] == 200


def test_what_another_page_embeds_is_refused_but_a_link_is_not(server):
    for site in ["cross-site", "same-site"]:
        assert ask(server, "/assets/main.js", Sec_Fetch_Site=site, Sec_Fetch_Mode="no-cors")[0] == 403
        assert ask(server, "/", Sec_Fetch_Site=site, Sec_Fetch_Mode="navigate")[0] == 200


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS"])
def test_nothing_can_be_sent(server, method):
    assert ask(server, "/", method)[0] == 501


def test_every_answer_forbids_other_sources(server):
    for path in ["/", "/assets/main.js", "/session/0", "/nothing"]:
        headers = ask(server, path)[1]
        assert headers["Content-Security-Policy"] == "default-src 'none'; script-src 'self'; frame-ancestors 'none'"
        assert "Access-Control-Allow-Origin" not in headers
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert headers["Cross-Origin-Resource-Policy"] == "same-origin"


@pytest.mark.skipif(not (module.STATIC / "index.html").is_file(), reason="the editor is not built here")
def test_the_header_says_what_the_built_page_says():
    page = (module.STATIC / "index.html").read_text()
    [said] = map(html.unescape, re.findall(r'Content-Security-Policy" content="([^"]+)"', page))
    assert len(said.split("; ")) > 5
    with running(None, module.STATIC) as server:
        assert ask(server, "/")[1]["Content-Security-Policy"] == f"{said}; frame-ancestors 'none'"


def test_without_a_policy_nothing_is_served(static):
    (static / "content-security-policy.txt").unlink()
    with pytest.raises(FileError, match="make editor"):
        EditorServer(static=static)


def test_head_has_the_headers_alone(server):
    status, headers, body = ask(server, "/assets/main.js", "HEAD")
    assert (status, headers["Content-Length"], body) == (200, "1", b"")


def test_a_file_that_is_gone_is_not_there(server, session):
    session.shape.unlink()
    assert ask(server, "/session/0")[0] == 404


def test_a_file_that_was_saved_anew_is_served_anew(server, session):
    (session.shape.parent / "new").write_bytes(b"v 1 1 1\n")
    (session.shape.parent / "new").rename(session.shape)
    assert ask(server, "/session/0")[2] == b"v 1 1 1\n"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_in_a_files_place_is_not_there(server, session):
    session.shape.unlink()
    os.mkfifo(session.shape)
    assert ask(server, "/session/0")[0] == 404


def test_a_link_in_a_files_or_a_folders_place_is_not_followed(server, session, tmp_path_factory):
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (elsewhere / "oak.mtl").write_text("secret")
    session.shape.unlink()
    session.shape.symlink_to(elsewhere / "oak.mtl")
    assert ask(server, "/session/0")[0] == 404
    mine = session.shape.parent / "mine"
    mine.rename(session.shape.parent / "was mine")
    mine.symlink_to(elsewhere)
    assert ask(server, "/session/1")[0] == 404


def test_another_folder_in_the_shapes_folders_place_is_not_read(static, session, tmp_path):
    folder = tmp_path / "folder"
    folder.mkdir()
    shape = session.shape.rename(folder / "chair.obj")
    with running(Session(shape, {}), static) as server:
        folder.rename(tmp_path / "moved")
        folder.mkdir()
        shape.write_text("secret")
        assert ask(server, "/session/0")[2] == b"v 0 0 0\n"


def test_nothing_is_read_once_it_is_closed(static, session):
    with EditorServer(session, static=static) as server:
        files = [content for content in server.contents.values() if isinstance(content, File)]
    assert len(files) > 5
    for file in files:
        with pytest.raises(OSError, match="Bad file descriptor"):
            file.open()


def test_links_are_followed_where_the_user_named_them_and_inside_of_the_folder(static, session, tmp_path):
    link, inside = tmp_path / "link.obj", tmp_path / "oak.mtl"
    link.symlink_to(session.shape)
    inside.symlink_to(tmp_path / "mine" / "oak.mtl")
    with running(Session(link, {"oak.mtl": inside}), static) as server:
        assert ask(server, "/session/0")[2] == b"v 0 0 0\n"
        assert ask(server, "/session/1")[2] == b"newmtl oak\n"


def test_a_link_out_of_the_folder_is_refused_by_name(static, session, tmp_path, tmp_path_factory):
    secret = tmp_path_factory.mktemp("elsewhere") / "secret"
    secret.write_text("secret")
    (tmp_path / "oak.png").symlink_to(secret)
    with pytest.raises(FileError, match=r"chair\.obj: 'oak\.png' beside it is a link that leads out of its folder"):
        EditorServer(Session(session.shape, {"oak.png": tmp_path / "oak.png"}), static=static)


@pytest.mark.parametrize(
    "path", ["/", "/session.json", "/session/0", "/assets/main.js", "//session/0", "/{wrong}/", "/?"]
)
def test_without_the_word_that_only_the_user_was_told_there_is_nothing(server, path):
    for wrong in ["A" * len(server.token), server.token[:-1], server.token.swapcase(), "é"]:
        status, _, body = ask_exactly(server, urllib.parse.quote(path.format(wrong=wrong), safe="/?"))
        assert (status, body) == (403, b"open the address that neuralmls edit has printed")


def test_the_word_is_another_one_each_time_and_cannot_be_guessed(static):
    with EditorServer(static=static) as first, EditorServer(static=static) as second:
        assert first.token != second.token
        assert len(first.token) >= 20


def test_the_address_that_a_browser_is_started_with_leads_to_the_page_once(server):
    once = urllib.parse.urlsplit(server.url_once()).path
    assert server.token not in once
    assert ask_exactly(server, once, "HEAD")[0] == 403
    status, headers, _ = ask_exactly(server, once)
    assert (status, headers["Location"]) == (303, server.url)
    assert ask_exactly(server, once)[0] == 403


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        (b"GET http://[::1", b"expected an address"),
        (b"GET http://[::1 HTTP/1.1", b" 400 "),
        (b"GET * HTTP/1.1", b" 400 "),
        (b"nonsense", b"400"),
        (b"GET /" + b"x" * 20_000 + b" HTTP/1.1", b" 414 "),
        (b"GET / HTTP/1.1\r\nX: " + b"x" * 20_000, b" 431 "),
        (b"GET / HTTP/1.1" + b"\r\nX: 1" * 5_000, b" 431 "),
        (b"\0\xff GET", b"400"),
    ],
)
def test_a_request_that_is_none_is_answered_without_a_word_in_the_terminal(server, capfd, line, answer):
    assert answer in say(server, line + b"\r\n\r\n")
    assert ask(server, "/")[0] == 200
    assert capfd.readouterr().err == ""


def say(server: EditorServer, data: bytes) -> bytes:
    """Send something and return what comes until the server hangs up."""
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=10) as raw:
        answer = b""
        with contextlib.suppress(ConnectionError):  # as it may have hung up before everything was sent
            raw.sendall(data)
            while more := raw.recv(65536):
                answer += more
        return answer


def test_clients_that_say_nothing_keep_nobody_waiting_and_are_bounded(server):
    with contextlib.ExitStack() as stack:
        before = threading.active_count()
        for i in range(3 * MOST):
            raw = stack.enter_context(socket.create_connection(("127.0.0.1", server.server_port), timeout=10))
            raw.sendall(b"GET / HTTP/1.1\r\nHost:" if i % 2 else b"")
            assert threading.active_count() <= before + MOST + 1
        started = time.monotonic()
        assert ask(server, "/session/0")[0] == 200
        assert time.monotonic() - started < 2


def test_a_client_that_dawdles_is_cut_off_although_it_goes_on_talking(server):
    server.connections.seconds_to_ask = 0.5
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=0.05) as raw:
        started = time.monotonic()
        with contextlib.suppress(ConnectionError):
            while time.monotonic() - started < 10:
                raw.sendall(b"x")
                with contextlib.suppress(TimeoutError):
                    if raw.recv(1) == b"":
                        break
        assert 0.4 < time.monotonic() - started < 5


def test_who_is_being_answered_is_not_cut_off_for_others(server, session):
    large = os.urandom(8_000_000)
    session.shape.write_bytes(large)
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=10)
    connection.request("GET", f"/{server.token}/session/0")
    response = connection.getresponse()
    with contextlib.ExitStack() as stack:
        for _ in range(2 * MOST):
            stack.enter_context(socket.create_connection(("127.0.0.1", server.server_port), timeout=10))
        assert response.read() == large
    connection.close()


def test_it_listens_on_this_machine_only(server):
    assert server.server_address[0] == "127.0.0.1"


def test_a_port_that_is_taken_is_refused_in_a_sentence_and_the_usual_one_gives_way(static, monkeypatch):
    with EditorServer(static=static) as first:
        with pytest.raises(ArgumentError, match=f"port {first.server_port}: cannot listen there"):
            EditorServer(static=static, port=first.server_port)
        monkeypatch.setattr(module, "USUAL_PORT", first.server_port)
        with EditorServer(static=static) as second:
            assert second.server_port != first.server_port


def test_an_editor_that_was_not_built_is_a_sentence(tmp_path):
    with pytest.raises(FileError, match="make editor"):
        EditorServer(static=tmp_path)
