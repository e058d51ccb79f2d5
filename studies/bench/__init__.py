"""How fast everything is: `python -m studies.bench` (or `make bench`).

Each measurement runs once unmeasured, then several times, in turn with the others, so that a busy
moment of the machine does not fall on one of them alone; medians are reported.  All are of the
default design (the STIM300 preset) on random full-scale samples; simulations of the RTL tell the
clocks they run in a second too.  Then the navigator runs against `python-ins` (`navigators`),
where that is installed.
"""
