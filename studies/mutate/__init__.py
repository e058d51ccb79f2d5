"""Mutants of the emitted Verilog against the test bench that is handed out.

mutants     changes of a core: by Yosys's `mutate`, and bits of the microprogram
bench       the bench, compiled for two simulators
equivalence  a changed core against the core, by the model checker
miter       both in one circuit, as small as it goes
pairs       both at once on sets of pairs of bits, where the program's place is known
verdicts    what the bench says of each mutant, and what is known of survivors
page        the words and tables of mutants.md
command     the command line
"""
