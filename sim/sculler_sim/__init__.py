"""Drives the RTL: the emitted Verilog in Verilator, the Amaranth design in its own simulator.

`engine.simulate` and `engine.trace` are the way in; `vectors_file` and `compare` read and write
what they give; `testbench` checks the Verilog where there is no Python.
"""
