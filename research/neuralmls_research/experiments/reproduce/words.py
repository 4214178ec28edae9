"""How numbers of several seeds are said."""

from __future__ import annotations

from collections.abc import Sequence


def span(values: Sequence[float], form: str = "{:.3g}") -> str:
    """The least and the largest of a value a seed, or the one that they share.

    Examples
    --------
    >>> span([0.25, 0.5, 0.3]), span([1, 1])
    ('0.25 to 0.5', '1')
    """
    least, most = form.format(min(values)), form.format(max(values))
    return least if least == most else f"{least} to {most}"
