"""The fuzzer that stays: valid inputs of every verb, corrupted; `make fuzz SEED=1 N=5000`.

A case is a target (`targets`), one of whose files or options is corrupted (`corruptions`), run in
a forked child of a warm process (`running`).  Seed and number say everything about it.
"""
