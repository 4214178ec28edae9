"""The folders of test data, and how fast tests train: as for the package itself."""

from tests.conftest import brief_training, data, golden

__all__ = ["brief_training", "data", "golden"]
