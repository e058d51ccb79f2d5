"""Which families' block memories the emitted memories become, by Yosys."""
