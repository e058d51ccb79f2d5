"""The core's parts, each with one job.

A part that takes time is planned before it is built: its plan says at which clocks the bits of its
inputs are looked at and those of its outputs are there (`words`), so pipelines line up by adding.
"""
