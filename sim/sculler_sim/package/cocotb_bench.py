"""test_NAME.py: a bench for cocotb and pytest, which reads the vectors of the plain bench."""

from __future__ import annotations

from importlib import resources
from string import Template

from sculler_model.golden import Timing, words_per_result
from sculler_sim.package.contents import Contents
from sculler_sim.testbench import LEAST, run_lengths


class _Template(Template):
    delimiter = "%%"


def cocotb_bench(contents: Contents, timing: Timing) -> str:
    """The text of test_NAME.py.

    Args:
        contents: the package.
        timing: the core's clocks.
    """
    design = contents.design
    before, after = run_lengths(design, timing, LEAST)
    parts = words_per_result(design) if design.hardware.handover == "stream" else 1
    template = resources.files("sculler_sim.package").joinpath("cocotb_bench.py.in")
    return _Template(template.read_text(encoding="ascii")).substitute(
        name=contents.name,
        sources=" ".join((*contents.verilog, *contents.models)),
        before=before,
        samples=before + after,
        words_before=before // design.samples_per_major * parts,
        words=(before // design.samples_per_major + after // design.samples_per_major) * parts,
        drops=design.drops_results,
        reset=contents.reset.port,
        resets=int(contents.reset.active_high),
        # clocks without a transfer after which nothing more comes
        patience=2 * (timing.startup + timing.before + timing.latency + max(timing.work, default=0))
        + 100,
    )
