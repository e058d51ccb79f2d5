"""Savage-20's error budgets flown: a campaign for 1 and 0.1 nmi/h, source by source."""
