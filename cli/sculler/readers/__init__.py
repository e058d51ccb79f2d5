"""Foreign IMU logs, one module per family of formats; `sculler convert` makes core logs of them.

`registry` has the formats, `recording` what a reader yields; `timing`, `rollover`, `running_sums`
make sense of stamps and sums.  This package imports nothing, so that `--help` is quick.
"""
