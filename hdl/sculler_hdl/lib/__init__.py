"""Parts that both cores, or other designs, can use: delays, adders, multipliers, accumulators.

A part that takes time is planned before it is built: its plan (`sculler_hdl.plan`) says at which
clocks the bits of its inputs are looked at and those of its outputs are there, so pipelines line up
by adding.  A function whose name begins with `emit_` puts hardware into a module that it is given.
"""
