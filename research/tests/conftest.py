"""The folders of test data, and how fast tests train: as for the package itself."""

from tests.conftest import data, golden

__all__ = ["data", "golden"]
