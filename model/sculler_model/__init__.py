"""What is true: the algorithms in exact integers, and what a host makes of them in floats.

Rooms, each a package whose `__init__` is its public face; the arrows point down:

    analysis    studies of accuracy, advice
    motion      truth motions and their exact samples
    navigation  navigator, alignment, errors against a truth
    host        Φ, α, ΔV_SF, ΔR_SF from a core's integers
    samples     quantising, resampling, instants, plausibility
    frames      rotations and the Earth
    fast        the golden model's vectorised twin
    golden      the golden model and the cycle model, in plain integers
    design      the design file, word lengths, the result's columns
    algorithms  tap tables and their families

`errors`, `schema`, `inputs` and `outputs` stand below all of them.
"""
