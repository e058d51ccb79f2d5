"""Error analysis: what a design leaves under vibration, in manoeuvres and through its resolution.

Each study gives the closed form and, beside it, what comes out of the integer path: counts through
`FastModel` and the host.
"""
