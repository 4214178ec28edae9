"""`neuralmls edit`: what it serves until it is interrupted, and what it refuses before."""

from __future__ import annotations

import http.client
import json
import re
import signal
from pathlib import Path

import pytest

import neuralmls.editor_server.server as server

# The command line with a built editor of one page.
PROGRAM = """\
import sys
from pathlib import Path
import neuralmls.editor_server.server as server
server.EditorServer.__init__.__kwdefaults__["static"] = Path("static")
from neuralmls.cli import main
sys.exit(main())
"""


@pytest.fixture
def built(here: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (here / "static").mkdir()
    (here / "static" / "index.html").write_text("<title>the editor</title>")
    (here / "static" / server.POLICY).write_text("default-src 'self'")
    monkeypatch.setitem(server.EditorServer.__init__.__kwdefaults__, "static", here / "static")
    return here


def test_it_serves_the_shape_until_it_is_interrupted(built, start):
    (built / "shape.obj").write_text("mtllib shape.mtl\n" + (built / "shape.obj").read_text())
    (built / "shape.mtl").write_text("newmtl oak\nmap_Kd oak grain.png\n")
    (built / "oak grain.png").write_bytes(b"png")
    with start("edit", "shape.obj", "--points", "points.csv", "--no-browser", program=PROGRAM) as running:
        line = running.stderr.readline().decode()
        found = re.search(r"http://127\.0\.0\.1:(\d+)(/[\w-]{20,}/)\?session", line)
        assert found, line
        connection = http.client.HTTPConnection("127.0.0.1", int(found[1]), timeout=10)
        connection.request("GET", f"{found[2]}session.json")
        listed = json.loads(connection.getresponse().read())
        connection.close()
        running.send_signal(signal.SIGINT)
        out, err = running.communicate(timeout=30)
    assert [file["name"] for file in listed["files"]] == ["shape.obj", "shape.mtl", "oak grain.png"]
    assert listed["points"]["name"] == "points.csv"
    assert (running.returncode, out, err) == (0, b"", b"neuralmls: stopped\n")


def test_the_browser_is_started_with_an_address_that_serves_once(built, run, monkeypatch):
    started = []
    monkeypatch.setattr("webbrowser.open", lambda url: not started.append(url))
    monkeypatch.setattr(server.EditorServer, "serve_forever", lambda self: started.append(self.token))
    ran = run("edit", "shape.obj")
    url, token = started
    assert ran.code == 0
    assert token in ran.err
    assert token not in url


def test_broken_input_is_refused_before_anything_is_served(built, refused):
    (built / "broken.obj").write_text("v 1 2\n")
    refused(1, "edit", "broken.obj", "--no-browser", words=("broken.obj", "line 1"))
    refused(1, "edit", "missing.obj", "--no-browser", words=("missing.obj", "there is no such file"))
    refused(1, "edit", "shape.obj", "--points", "missing.csv", "--no-browser", words=("missing.csv",))
    refused(2, "edit", "--points", "points.csv", "--no-browser", words=("--points", "shape"))
    refused(2, "edit", "--port", "0", "--no-browser", words=("port",))


def test_without_a_built_editor_it_says_how_to_build_it(here, refused, monkeypatch):
    monkeypatch.setitem(server.EditorServer.__init__.__kwdefaults__, "static", here / "static")
    refused(1, "edit", "shape.obj", "--no-browser", words=("make editor", "Node.js"))
