"""Requirements of the core with their design, tests and proofs: where a certification begins."""
