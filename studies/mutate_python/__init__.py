"""Mutants of the Python against its own fast tests.

subjects    what is mutated, and the tests that should see it
changes     places of a source and the changes that cosmic-ray makes there
runs        a copy of the tree, and what the tests say of a mutant
verdicts    what came of each mutant, kept; what people say of those that live
page        the words and tables of mutants-python.md
command     the command line
steady      a plugin of pytest: Hypothesis gives the same examples in every run
"""
