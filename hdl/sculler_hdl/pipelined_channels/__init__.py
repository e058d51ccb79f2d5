"""The pipelined core with many channels: what it keeps of each stands in block memory."""
