"""Real place-and-route of a generated core, with Yosys and nextpnr from PyPI.

`placement.place` takes a design and a device to clock rate, area and worst path; `netlist`
simulates what was placed.  The tools are the optional extra `sculler[place]` and run as processes
of their own.
"""
