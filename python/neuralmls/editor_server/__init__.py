"""The built browser editor, served on this machine, with a shape already open."""

from neuralmls.editor_server.server import EditorServer, Session

__all__ = ["EditorServer", "Session"]
