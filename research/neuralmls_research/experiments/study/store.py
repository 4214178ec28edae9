"""Questions that are made already: a build that was stopped goes on where it was."""

from __future__ import annotations

import hashlib
import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from neuralmls.plugin import write_atomically
from neuralmls_research.experiments.study.cases import Case


@dataclass(frozen=True)
class Store:
    """A folder with a file for each question.

    Attributes
    ----------
    folder : Path
        It is made when the first question is put into it.
    made_of : str
        All that the results hang on beside the case: methods with their settings, weights, version. What was made of
        something else is not taken.
    """

    folder: Path
    made_of: str

    def get(self, number: int, case: Case) -> dict[str, Any] | None:
        """Return what was put for the question of this number; None where there is none, or of something else."""
        try:
            content: dict[str, Any] = json.loads(self._path(number).read_bytes())
        except (OSError, ValueError):
            return None
        return content["question"] if content.get("made_of") == self._digest(case) else None

    def put(self, number: int, case: Case, question: dict[str, Any]) -> None:
        """Keep a question, whole or not at all."""
        self.folder.mkdir(parents=True, exist_ok=True)
        content = {"made_of": self._digest(case), "question": question}
        write_atomically(self._path(number), json.dumps(content).encode())

    def clear(self) -> None:
        """Remove the folder: the study is done."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def _path(self, number: int) -> Path:
        return self.folder / f"q{number}.json"

    def _digest(self, case: Case) -> str:
        points = case.control_points
        digest = hashlib.sha256(repr((self.made_of, case.category, case.name, case.displacement)).encode())
        for array in (case.shape.positions, case.shape.faces, points.sources, points.targets):
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()
