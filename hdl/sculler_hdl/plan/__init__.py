"""What is to be built: widths, clocks and schedules, as plain Python without Amaranth.

For a part `X` of `sculler_hdl.lib`, `.pipelined` or `.compact` there is an `XPlan` here, in the
module of the same name.  It may import the exact side of the model and `sculler_hdl.targets`.
"""
