"""Trees of adders over skewed words."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from itertools import zip_longest

from amaranth import C, Cat, Module, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.adder import add
from sculler_hdl.lib.delay import SkewedSignal
from sculler_hdl.plan.adder_tree import AdderTreePlan, Node
from sculler_hdl.plan.arrival import spans, width
from sculler_hdl.plan.dot_product import DotProductPlan

Shared = dict[Hashable, SkewedSignal]
"""The sums that trees of one module have built, by `Node.key`."""

Term = tuple[Value, Value | None]
"""Bits of an addend; and the same a clock later, where registers have them."""


class AdderTree(wiring.Component):
    """The sum of shifted signed terms.

    The cores put the same adders into a part's own module (`emit_adder_tree`), so that their names
    in the Verilog text have one level less.

    Members:
        term0, term1, ...: the bits of the addends, as their arrivals say.
        output: the sum, signed, as `plan.arrival` says.

    Latency: one clock for each level of additions, and for each limb; one sum per clock.

    Args:
        plan: the plan.
    """

    def __init__(self, plan: AdderTreePlan) -> None:
        self.plan = plan
        super().__init__(
            {
                **{f"term{i}": In(width(one.arrival)) for i, one in enumerate(plan.addends)},
                "output": Out(plan.result.bits),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        terms = [getattr(self, f"term{i}") for i in range(len(self.plan.addends))]
        m.d.comb += self.output.eq(emit_adder_tree(m, "sum", self.plan, terms).value)
        return m


def emit_adder_tree(
    m: Module,
    name: str,
    plan: AdderTreePlan,
    terms: Sequence[Value],
    shared: Shared | None = None,
    later: Sequence[Value | None] = (),
) -> SkewedSignal:
    """Put the adders of a sum into a module.

    Args:
        m: the module.
        name: for the registers.
        plan: the plan.
        terms: the bits of the addends.
        shared: sums that other trees of the module have built, to be used again, shifted, if they
            are wide enough; those built now are added.  All addends need a `source`.
        later: the bits of the addends a clock later, where registers of the module have them.
    """
    both = list(zip_longest(terms, later))
    root = _emit_node(m, name, plan, plan.root, both, {} if shared is None else shared)
    parts = [
        root.slice_at(lo, hi, clock) for lo, hi, clock in spans(plan.arrival) if lo >= root.low
    ]
    zeros = [C(0, root.low)] if root.low else []
    return SkewedSignal(m, name, Cat(*zeros, *parts), plan.arrival)


def _emit_node(
    m: Module, name: str, plan: AdderTreePlan, node: Node, terms: Sequence[Term], shared: Shared
) -> SkewedSignal:
    addend = node.addend
    if node.parts is None:
        term, later = (C(0, 1), None) if node.order < 0 else terms[node.order]
        term_name = f"{name}_term{node.order}"
        return SkewedSignal(m, term_name, term, addend.arrival, addend.low, later)
    sum_name = f"{name}_sum{node.order}"
    if node.key not in shared or len(shared[node.key].value) < node.bits:
        left, right = (_emit_node(m, name, plan, part, terms, shared) for part in node.parts)
        shared[node.key] = add(
            left,
            right,
            sum_name,
            addend.low + node.bits,
            node.ready - 1,
            plan.limb,
            subtract=node.subtracts,
        )
    made = shared[node.key].value[: node.bits]
    return SkewedSignal(m, sum_name, made, addend.arrival, addend.low)


def emit_dot_product(
    m: Module, name: str, plan: DotProductPlan, words: Mapping[str, Value]
) -> Value:
    """Put a sum of words times constant integers into a module; its bits."""
    return emit_adder_tree(m, name, plan.tree, [words[one] for one in plan.names]).value
