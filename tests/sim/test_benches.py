"""The generated bench in Icarus Verilog: both cores on every target with blocks of its own.

The blocks' models and the core's text as they are handed out; the bench holds every port to the
golden vectors and to the core's timing on every clock.
"""

import pytest

from bench_files import PLAIN, run_bench
from dropping_designs import FEW_DROPPING
from position_designs import HIGH_RESOLUTION
from strategies import DESIGNS, on_targets
from tiers import cover, met, tiers

BENCHES = {
    f"{name}-{core}": on_target
    for core, high_resolution in (("compact", "savage_hr"), ("pipelined", "taylor_3p3_hr"))
    for design in [*DESIGNS.values(), HIGH_RESOLUTION[high_resolution]]
    for name, on_target in on_targets(design, core).items()
} | {f"{name}-dropping": design for name, design in FEW_DROPPING.items()}

SHORT = PLAIN._replace(before=(1, 50), after=(2, 100))
"""A reset after some 50 samples, then at least two major intervals."""


@pytest.mark.usefixtures("icarus")
@pytest.mark.parametrize("design", tiers(BENCHES, together=2))
def test_the_bench_passes(design, tmp_path):
    long = design.hardware.core == "compact" and not design.drops_results
    run_bench(design, tmp_path, PLAIN if long else SHORT)


def test_every_two_features_meet_at_every_change():
    """Target and hand-over, width and kind of table, ...: what is in all is in the few."""
    chosen = cover(BENCHES, together=2)
    assert len(chosen) <= 30
    found = set().union(*(met(BENCHES[name], 2) for name in chosen))
    for name, design in BENCHES.items():
        assert met(design, 2) <= found, name
