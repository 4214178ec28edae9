"""How to get what is not installed: in every message the same words, that work by name and from a checkout."""


def pip(package: str, folder: str) -> str:
    """Return how to install a package.

    >>> pip("neuralmls-research", "./research")
    'pip install neuralmls-research (in a checkout: pip install ./research)'
    """
    return f"pip install {package} (in a checkout: pip install {folder})"


def extra(name: str) -> str:
    """Return how to install the libraries of an extra.

    >>> extra("figures")
    "pip install 'neuralmls[figures]' (in a checkout: pip install --editable '.[figures]')"
    """
    return pip(f"'neuralmls[{name}]'", f"--editable '.[{name}]'")


RESEARCH = pip("neuralmls-research", "./research")
