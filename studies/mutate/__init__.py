"""Mutants of the emitted Verilog against the test bench that is handed out.

mutants     changes of a core: by Yosys's `mutate`, and bits of the microprogram
verdicts    what the bench says of each; survivors against the core, by the model checker
page        the words and tables of mutants.md
command     the command line
"""
