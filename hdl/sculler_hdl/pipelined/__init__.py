"""The pipelined core: up to one six-axis sample per clock, exact results once a major interval."""
