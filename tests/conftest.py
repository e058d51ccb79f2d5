"""What all tests share."""

from collections.abc import Iterator
from pathlib import Path

import pytest

CACHE = Path(__file__).parents[1] / "build" / "cache"


@pytest.fixture(scope="session", autouse=True)
def _cache() -> Iterator[None]:
    """Compiled simulators are kept in build/, not in the user's cache."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SCULLER_CACHE", str(CACHE))
        yield
