"""All that is known of a design's compact core before it is built, worked out once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from sculler_hdl.plan.compact.digits import MemorySizes, memory_sizes
from sculler_hdl.plan.compact.instructions import Program
from sculler_hdl.plan.compact.listing import figures, listing
from sculler_hdl.plan.compact.microcode import Microcode, encode, engine_timing
from sculler_hdl.plan.compact.pipeline import Pipeline, engine_pipeline
from sculler_hdl.plan.compact.program import compile_program
from sculler_hdl.targets import TARGETS, Target
from sculler_model.design import Design
from sculler_model.golden import Timing


@dataclass(frozen=True)
class CompactPlan:
    """What the compact core of a design is built of.

    Attributes:
        design: the design.
        target: whose blocks it uses.
        pipeline: the engine's delays.
        program: the schedule.
        microcode: the schedule as words of the program memory.
        timing: the clocks it takes.
    """

    design: Design
    target: Target
    pipeline: Pipeline
    program: Program
    microcode: Microcode
    timing: Timing

    @property
    def sizes(self) -> MemorySizes:
        """Of its memories."""
        return self.program.sizes

    @property
    def serial(self) -> bool:
        """Whether it multiplies bit by bit, without a multiplier block."""
        return self.design.hardware.multipliers == 0

    @property
    def resources(self) -> dict[str, int]:
        """Figures for the manifest."""
        return figures(self.program, self.pipeline, self.microcode, self.timing)

    @property
    def listing(self) -> str:
        """The schedule as text."""
        return listing(self.program, self.pipeline, self.microcode, self.timing)


@lru_cache(maxsize=32)
def plan_compact(design: Design) -> CompactPlan:
    """Compile a design's schedule."""
    pipeline = engine_pipeline(design)
    program = compile_program(design, memory_sizes(design), pipeline.store)
    code = encode(program, pipeline)
    timing = engine_timing(program, pipeline, code)
    target = TARGETS[design.hardware.target]
    return CompactPlan(design, target, pipeline, program, code, timing)
