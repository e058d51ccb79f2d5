"""Sums of samples times constant integers: taps (A, B) and weights (theta, v)."""

from amaranth import C, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.adder import add
from sculler_hdl.lib.adder_tree import Shared, emit_adder_tree
from sculler_hdl.lib.delay import APART, ControlDelay, SkewedSignal
from sculler_hdl.lib.layout import is_one_of, vector
from sculler_hdl.plan.arrival import later
from sculler_hdl.plan.weighted_sum import Gate, WeightedSumPlan
from sculler_model.design import AXES


class WeightedSum(wiring.Component):
    """sum over d of c[k][d] * sample[t-d] for three axes, by shifts and additions, no multiplier.

    The coefficients are split into signed digits.  Each sample is multiplied by the coefficients
    of all distances when it comes, and the products wait in a chain of partial sums that moves
    on by one distance with every sample (the transposed form of a filter):

        sample ─┬─────────┬─────────┐
               c[2]      c[1]      c[0]
                └▶ sum 2 ─▶ sum 1 ──▶ sum 0

    So the chain holds the history, and what earlier samples add to a sum has long been added when
    the sum's last sample comes.  A sum without distance 0 is there before its own sample's step.

    Members:
        step (clock 0): a sample stands on `samples`.
        phase (clock -1): the sample's phase, 0..n-1; not looked at unless `plan.is_gated`.
        samples (clock 0): the newest sample, three axes.
        output: the sum that belongs to the sample, for each sample in turn, as `plan.arrival` says.

    Latency: `plan.arrival`; one sum per clock.  Reset makes all earlier samples 0.

    Args:
        plan: the plan.
        inverted: how its flags are held (`ControlDelay`), to keep them apart from another's.
    """

    def __init__(self, plan: WeightedSumPlan, *, inverted: bool = False) -> None:
        self.plan = plan
        self.inverted = inverted
        super().__init__(
            {
                "step": In(1),
                "phase": In(range(plan.phase_count)),
                "samples": In(vector(plan.counts)),
                "output": Out(vector(plan.result)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        step = ControlDelay(m, "step", self.step, inverted=self.inverted)
        for i, axis in enumerate(AXES):
            sample = self.samples[i]
            # marked, for where a core has the delayed sample too, that one stands elsewhere
            delayed = Signal.like(sample, name=f"later_{axis}", reset_less=True, attrs=APART)
            m.d.sync += delayed.eq(sample)
            gated: dict[Gate | None, Value] = {None: sample}
            for number, gate in enumerate(plan.gates):
                # one for each axis, for it to stand there
                is_open = Signal(name=f"open{number}_{axis}", reset_less=True, attrs=APART)
                m.d.sync += is_open.eq(is_one_of(self.phase, list(gate)))
                register = Signal.like(sample, name=f"gated{number}_{axis}", reset_less=True)
                m.d.sync += register.eq(Mux(is_open, sample, 0))
                gated[gate] = register
            products: dict[int, SkewedSignal] = {}
            shared: Shared = {}
            for d in sorted(plan.products):  # the widest first, for the others to share its sums
                gates_of = [plan.gate(term) for term in plan.terms[d]]
                products[d] = emit_adder_tree(
                    m,
                    f"product{d}_{axis}",
                    plan.products[d],
                    [gated[gate] for gate in gates_of],
                    shared,
                    [delayed if gate is None else None for gate in gates_of],
                )
            total = self._chain(m, axis, products, step)
            if total is not None:
                m.d.comb += self.output[i].eq(total.value)
        return m

    def _chain(
        self, m: Module, axis: str, products: dict[int, SkewedSignal], step: ControlDelay
    ) -> SkewedSignal | None:
        """The partial sums, each of which takes up the one before and a product with each step."""
        plan = self.plan
        total: SkewedSignal | None = None
        for d in plan.distances:
            bits = plan.bits(d)
            nothing = SkewedSignal(m, "nothing", C(0, 0), (), low=bits)
            moved = add(
                total or nothing,
                products.get(d, nothing),
                f"sum{d}_{axis}",
                bits,
                plan.clock,
                plan.limb,
                step=lambda q: step.at_clock(plan.clock + q),
            )
            # its step is the last clock that shows a partial sum of the samples before
            total = SkewedSignal(m, f"sum{d}_{axis}", moved.value, later(moved.arrival, -1))
        return total
