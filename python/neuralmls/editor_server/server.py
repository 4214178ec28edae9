"""A server for one browser on this machine: the built editor, one shape with its companions, and nothing else.

Every address that it answers is known before it starts, so that no request can name a file, and every address begins
with a word that nobody can guess, so that other users of this machine get nothing. Requests under another name than
this machine's own (DNS rebinding) and those that other pages make are refused.
"""

from __future__ import annotations

import errno
import json
import secrets
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from http.server import ThreadingHTTPServer
from pathlib import Path
from typing import Any

from neuralmls.editor_server.connections import Connections
from neuralmls.editor_server.folder import File, Folder
from neuralmls.editor_server.handler import Handler
from neuralmls.errors import ArgumentError, FileError

STATIC = Path(__file__).parent / "static"
ADDRESS = "127.0.0.1"
# The browser keeps unsaved work under the server's address and port, so that it should be the same each time.
USUAL_PORT = 8417

# What the built editor may do, in a file of the build (editor/security.ts); and what only a header can say.
POLICY = "content-security-policy.txt"
NOT_IN_FRAMES = "frame-ancestors 'none'"


@dataclass(frozen=True)
class Session:
    """What is open when the editor starts."""

    shape: Path
    companions: dict[str, Path]
    """Files beside the shape, by the names that it gives them."""
    points: Path | None = None


class EditorServer(ThreadingHTTPServer):
    """Listens from its construction on; `serve_forever` answers."""

    daemon_threads = True
    request_queue_size = 64

    def __init__(self, session: Session | None = None, *, port: int | None = None, static: Path = STATIC) -> None:
        """Listen on 127.0.0.1, at `port` or else at the usual port or, where that is taken, any.

        Raises
        ------
        FileError
            The editor has not been built into the folder `static`, or a file of the session lies elsewhere than it
            says.
        ArgumentError
            The port is taken or not allowed.
        """
        if not all((static / name).is_file() for name in ("index.html", POLICY)):
            raise FileError("the editor has not been built here: run 'make editor', which needs Node.js 20 or later")
        policy = (static / POLICY).read_text(encoding="utf-8").strip()
        self.policy = f"{policy}; {NOT_IN_FRAMES}"
        self.token = secrets.token_urlsafe(16)
        self.connections = Connections()
        self._ticket: str | None = None
        self._folders: list[Folder] = []
        self.session = session
        self._listen(port)
        try:
            self.contents = dict(self._build(static))
            if session is not None:
                self.contents |= self._addresses(session)
        except BaseException:
            self.server_close()
            raise

    @property
    def url(self) -> str:
        """The page to open."""
        return f"http://{ADDRESS}:{self.server_port}/{self.token}/" + ("?session" if self.session else "")

    @property
    def hosts(self) -> set[str]:
        """The names by which a request may call this server."""
        return {f"{name}:{self.server_port}" for name in (ADDRESS, "localhost")}

    def url_once(self) -> str:
        """An address that leads to the page once: every user of this machine can see what a browser is started with."""
        self._ticket = secrets.token_urlsafe(16)
        return f"http://{ADDRESS}:{self.server_port}/{self._ticket}"

    def redeem(self, ticket: str) -> bool:
        """Whether this is the address of `url_once`, which it then no longer is."""
        if self._ticket is None or not secrets.compare_digest(ticket.encode(), self._ticket.encode()):
            return False
        self._ticket = None
        return True

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer in a thread, as far as there is room for one."""
        if self.connections.admit(request):
            super().process_request(request, client_address)
        else:
            super().shutdown_request(request)

    def shutdown_request(self, request: Any) -> None:
        """Called once for every admitted connection, at its end."""
        self.connections.end(request)
        super().shutdown_request(request)

    def service_actions(self) -> None:
        """Called twice a second."""
        self.connections.cut_late()

    def handle_error(self, request: Any, client_address: Any) -> None:  # noqa: ARG002
        """Say what went wrong in one line; that a browser went away is nothing wrong."""
        error = sys.exception()
        if not isinstance(error, OSError):
            print(f"neuralmls: warning: a request to the editor's server failed: {error!r}", file=sys.stderr)

    def server_close(self) -> None:
        """Stop listening."""
        super().server_close()
        for folder in self._folders:
            folder.close()

    def _listen(self, port: int | None) -> None:
        try:
            super().__init__((ADDRESS, USUAL_PORT if port is None else port), Handler)
        except OSError as error:
            if port is not None or error.errno != errno.EADDRINUSE:
                number = USUAL_PORT if port is None else port
                raise ArgumentError(f"port {number}: cannot listen there: {error.strerror or error}") from error
            super().__init__((ADDRESS, 0), Handler)

    def _folder(self, path: Path) -> Folder:
        self._folders.append(Folder(path))
        return self._folders[-1]

    def _build(self, static: Path) -> Iterator[tuple[str, File | bytes]]:
        folder = self._folder(static)
        for path in static.rglob("*"):
            if path.is_file() and (file := folder.file(path)):
                yield "/" + path.relative_to(static).as_posix(), file
                if path == static / "index.html":
                    yield "/", file

    def _addresses(self, session: Session) -> dict[str, File | bytes]:
        """What the session adds, with a list of it that the editor reads first."""
        files = {session.shape.name: self._given(session.shape)}
        beside = self._folder(session.shape.parent)
        for name, path in session.companions.items():
            if (file := beside.file(path)) is None:
                raise FileError(f"{session.shape}: '{name}' beside it is a link that leads out of its folder")
            files[name] = file
        contents: dict[str, File | bytes] = {f"/session/{i}": file for i, file in enumerate(files.values())}
        listed = [{"name": name, "address": f"session/{i}"} for i, name in enumerate(files)]
        points = None
        if session.points is not None:
            contents["/session/points"] = self._given(session.points)
            points = {"name": session.points.name, "address": "session/points"}
        described = {"shape": session.shape.name, "files": listed, "points": points}
        contents["/session.json"] = json.dumps(described).encode()
        return contents

    def _given(self, path: Path) -> File:
        """A file that the user named, wherever its links lead now."""
        try:
            real = path.resolve(strict=True)
            return File(self._folder(real.parent), (real.name,))
        except OSError as error:
            raise FileError(f"{path}: cannot read: {error.strerror or error}") from error
