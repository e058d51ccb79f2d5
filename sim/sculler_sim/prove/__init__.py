"""Proofs on the emitted Verilog, by Yosys and the model checker in it (ABC), as PyPI has them.

problem     core and properties as one netlist of gates and registers
counter     the same from every value of the counter of results
arithmetic  the results of a core of a few bits beside the page's integers
word_lengths  its accumulators in the intervals that the design declares
engine      a property of it proved, refuted, or held for so many clocks
structure   what each output depends on within a clock
claims      what is claimed of a core, settled
shapes      small designs that between them have every structure of both cores
"""
