"""Which result of the page is which method's: known to the report, not to the participant.

The key travels with the page and the answers, packed so that nobody reads it by accident; a file of answers is
therefore all that the report needs. The name of a study is the key's digest, so that neither changes without the other.
"""

from __future__ import annotations

import base64
import binascii
import hashlib
import json
import zlib
from dataclasses import asdict, dataclass

from neuralmls.errors import FileError


@dataclass(frozen=True)
class Question:
    """What a question of the page shows.

    Attributes
    ----------
    id : str
        What page and answers call it.
    category, shape, displacement : str
        Which deformation of the study.
    origin : str
        Where the shape comes from.
    methods : tuple of str
        The method that made each result, in the order of the page's file.
    left_out : dict
        Why other methods have no result here, by their name.
    asked : str
        What the page asks, as `WORDINGS` names it.
    """

    id: str
    category: str
    shape: str
    displacement: str
    origin: str
    methods: tuple[str, ...]
    left_out: dict[str, str]
    asked: str = "best"  # as pages did before there was another question


def sealed(questions: list[Question], pictures: str) -> tuple[str, str]:
    """Pack the key; return the study's name and the packed key. `pictures` is a digest of what is shown."""
    content = {"pictures": pictures, "questions": [asdict(question) for question in questions]}
    packed = zlib.compress(json.dumps(content).encode(), 9)
    return _name(packed), base64.b64encode(packed).decode()


def opened(study: str, key: str) -> list[Question]:
    """Unpack the key of the study of that name.

    Raises
    ------
    FileError
        It is damaged, or another study's.
    """
    try:
        packed = base64.b64decode(key, validate=True)
        if _name(packed) != study:
            raise FileError("its key is not that of its study: the file was changed or damaged")
        content = json.loads(zlib.decompress(packed))
        return [Question(**{**entry, "methods": tuple(entry["methods"])}) for entry in content["questions"]]
    except (binascii.Error, zlib.error, ValueError, KeyError, TypeError) as error:
        if isinstance(error, FileError):
            raise
        raise FileError("its key cannot be read: the file was changed or damaged") from error


def _name(packed: bytes) -> str:
    return hashlib.sha256(packed).hexdigest()[:16]
