"""What is true: algorithm design, word lengths, golden models, navigation.

The exact side (`design`, `coefficients`, `wordlength`, `golden`, `cycles`, `vectors`) is plain
integers and knows no floats beyond the design's scale factors; everything else is the host's.
"""

from sculler_model.coefficients import TapTable
from sculler_model.cycles import CycleModel
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import GoldenModel
from sculler_model.vectors import COLUMNS, Result

__all__ = ["COLUMNS", "CycleModel", "Design", "GoldenModel", "InputError", "Result", "TapTable"]
