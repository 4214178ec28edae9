"""Figures of shapes: needs the extra `figures` (PyVista)."""
