"""A plugin of pytest: Hypothesis gives the same examples in every run, and seeks no smaller ones.

Without it a mutant could live in one run and not in the next.  No example has a deadline: a slow
machine is no fault.
"""

from hypothesis import Phase, settings

settings.register_profile(
    "mutants",
    derandomize=True,
    database=None,
    deadline=None,
    phases=(Phase.explicit, Phase.generate),
)
settings.load_profile("mutants")
