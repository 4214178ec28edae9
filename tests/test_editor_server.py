"""The editor's server: tells this machine's browser of the editor and one shape, and nobody of anything else."""

from __future__ import annotations

import html
import http.client
import json
import re
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import neuralmls.editor_server.server as module
from neuralmls.editor_server import EditorServer, Session
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
    assert server.url.endswith("/?session")


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
            raw.sendall(f"GET /session/0 HTTP/1.1\r\n{hosts}Connection: close\r\n\r\n".encode())
            with raw.makefile("rb") as stream:
                assert b" 403 " in stream.readline()


@pytest.mark.parametrize("origin", ["https://example.org", "null", "http://127.0.0.1:1", "file://"])
def test_requests_of_other_pages_are_refused(server, origin):
    assert ask(server, "/session/0", Origin=origin)[0] == 403
    assert ask(server, "/session/0", Origin=server.url.split("/?")[0])[0] == 200


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
