"""What all tests share."""

import gc
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


@pytest.fixture
def rare_collection() -> Iterator[None]:
    """Python looks for garbage rarely.

    Elaborating a large core makes millions of objects that all stay until it is done: looking
    through them again and again takes half the time.
    """
    before = gc.get_threshold()
    gc.set_threshold(200_000, 20, 20)
    yield
    gc.set_threshold(*before)
