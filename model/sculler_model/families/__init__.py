"""Coefficient families beyond the two closed forms in `sculler_model.coefficients`.

`catalogue.make` designs any of them from a `Recipe`; `Design` does so from a design file.  All of
it is exact rationals and decimals of many digits, no floats of the machine, so that the same design
gives the same hardware everywhere.  `drift` is the float side: what a table leaves, for analysis.
docs/families.md has the derivations.
"""
