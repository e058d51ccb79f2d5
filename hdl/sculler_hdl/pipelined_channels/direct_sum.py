"""Sums of samples times constant integers, where all the samples stand there at once."""

from __future__ import annotations

from amaranth import C, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.adder_tree import emit_adder_tree
from sculler_hdl.lib.layout import is_one_of, vector
from sculler_hdl.plan.direct_sum import DirectSumPlan
from sculler_hdl.plan.weighted_sum import Gate
from sculler_model.design import AXES


class DirectSum(wiring.Component):
    """sum over d of c[k][d] * sample[t-d] for three axes, by shifts and additions, no multiplier.

    Members:
        phase (clock 0), if `plan.is_gated`: the newest sample's phase, 0..n-1.
        sampleD (clock 0): the sample of each distance D that is used, three axes.
        output: the sum, as `plan.arrival` says.

    Latency: `plan.arrival`; one sum per clock.

    Args:
        plan: the plan.
    """

    def __init__(self, plan: DirectSumPlan) -> None:
        self.plan = plan
        self.distances = sorted({term.distance for term in plan.shifted})
        phase = {"phase": In(range(plan.phase_count))} if plan.is_gated else {}
        super().__init__(
            {
                **phase,
                **{f"sample{d}": In(vector(plan.counts)) for d in self.distances},
                "output": Out(vector(plan.result)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        gates = {gate: is_one_of(self.phase, list(gate)) for gate in plan.gates}
        for i, axis in enumerate(AXES):
            gated: dict[tuple[int, Gate | None], Value] = {}
            terms: list[Value] = []
            for term in plan.shifted:
                gate = plan.gate(term)
                key = term.distance, gate
                if key not in gated:
                    sample: Value = Value.cast(getattr(self, f"sample{term.distance}")[i])
                    if gate is not None:
                        name = f"gated{len(gated)}_{axis}"
                        register = Signal(len(sample), name=name, reset_less=True)
                        m.d.sync += register.eq(Mux(gates[gate], sample, 0))
                        sample = register
                    gated[key] = sample
                terms.append(gated[key])
            tree = emit_adder_tree(m, f"sum_{axis}", plan.tree, terms or [C(0, 1)])
            m.d.comb += self.output[i].eq(tree.value)
        return m
