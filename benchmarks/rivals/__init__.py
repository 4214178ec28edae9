"""The same work done by others, each as its users would do it."""

from importlib.util import find_spec


def installed(name: str) -> bool:
    """Whether a rival's package is there (`bench` of research/pyproject.toml installs all of them)."""
    return find_spec(name) is not None
