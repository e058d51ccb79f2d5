"""The core's parts, each with one job.

Every part that takes time has an attribute `latency`: clocks from an input to the output that
depends on it.  All parts take one item per clock, so pipelines line up by adding latencies.
"""
