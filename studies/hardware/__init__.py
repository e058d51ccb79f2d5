"""What the cores reach in real devices: `python -m studies.hardware` (or `make hardware`).

Writes the page hardware.md and its pictures.  Nothing in it is typed in but the figures asked for,
the published one and the words.  What Yosys and nextpnr found is kept in the cache folder, each
seed by itself, under a hash of Verilog, device, seed, the tools' versions and the placing code.  So
a run that was broken off goes on where it stopped, and a row whose design is as it was is free.
"""
