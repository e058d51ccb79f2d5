"""What is true: algorithm design, word lengths, the golden models, and the host's navigation.

The exact side (`design`, `coefficients`, `wordlength`, `vectors`, `golden`, `cycles`) is plain
integers and knows no floats beyond the design's scale factors; everything else is the host's.
Import from the modules; the package itself imports nothing, so that `sculler --help` is quick.
"""
