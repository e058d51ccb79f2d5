"""Drives the RTL: the emitted Verilog in Verilator, the Amaranth design in its own simulator.

`engine.simulate` and `engine.trace` are the way in, `engines` the simulators behind them; `run`,
`stimulus` and `surroundings` are the rules of a run; `testbench` checks the Verilog where there is
no Python; `place` holds real place-and-route.
"""
