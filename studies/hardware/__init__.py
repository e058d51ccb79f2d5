"""What the cores reach in real devices: `python -m studies.hardware` (or `make hardware`).

Writes the page hardware.md and its pictures.  Nothing in it is typed in but the figures asked for,
the published one and the words.  What Yosys and nextpnr found is kept in the cache folder, so that
a second run is quick, and the same program gives the same page.
"""
