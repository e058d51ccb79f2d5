"""Programs that are run side by side, and ended."""

from __future__ import annotations

import sys
import time

from sculler_sim import processes

SPEAKS_AND_WAITS = "import time; print('begun', flush=True); time.sleep(100)"


def test_what_still_runs_after_the_seconds_is_killed() -> None:
    begun = time.monotonic()
    slow, quick = processes.run(
        [sys.executable, "-c", SPEAKS_AND_WAITS], [sys.executable, "-c", "print(7)"], seconds=10
    )
    assert time.monotonic() - begun < 60
    assert slow.status != 0
    assert slow.said.splitlines() == ["begun"]
    assert (quick.status, quick.said.split()) == (0, ["7"])
