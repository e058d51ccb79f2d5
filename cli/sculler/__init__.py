"""The command line of sculler: files, reports and pictures over the model, hardware and simulators.

One module per verb in `sculler.commands`; `sculler.main.main` is the entry point.
"""
