"""Raw binary logs: the datagrams of sensors as they came from the line.

`datagrams` finds and counts them, `recording` makes samples with a clock of them; each format is a
module of its own with one `Protocol`.
"""
