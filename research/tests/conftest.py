"""The folders of test data: as for the package itself."""

from tests.conftest import data, golden

__all__ = ["data", "golden"]
