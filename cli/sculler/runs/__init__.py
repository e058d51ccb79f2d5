"""What the verbs do, as functions and classes without a command line.

Each room takes typed arguments and gives an outcome, a frozen dataclass:

- `runs.counts`: `model_log` and `simulate_log`, a log to vectors; they give a `Summary`.
- `runs.conversion`: `convert_log(Plan, output)`, a foreign log to an integer log.
- `runs.navigation`: `navigate_file(Plan, output)`, vectors to attitude, velocity and position;
  `NavigationRun` does it over blocks in memory.
- `runs.motion`: `write_motion(Plan, output, truth)`, a known motion to a log and its truth.
- `runs.analysis`, `runs.advice`: studies of designs, and the designs that meet a requirement.
- `runs.demo`: `run_demo(folder)`, the main job from end to end.
- `runs.hardware`: `write_hardware(design, folder)`, Verilog, manifest and test bench.
- `runs.placing`: `place_core(Plan)`, a core's clock rate and area in a real device.
- `runs.coefficients`: `of_design`, `of_family`, a tap table and what it leaves.
- `runs.engines`: `choose_engine`, which simulator there is.

All keep the same rules:

- They print nothing.  What a user should know is in the outcome's `warnings`; `as_json()` is the
  whole outcome as plain data, and `told(data)` or `facts()` the same in words.
- Long work tells how far it has come to a callback, `advance`, which is silent unless given.
- Outputs appear whole or not at all.
- What the user can mend raises `sculler_model.errors.InputError`; arguments that do not go together
  raise its subclass `ContradictionError`.

The rooms import `formats`, `readers`, `checks` and `plots`, never `commands` or `terminal`.  A room
loads numpy, and this page nothing, so that the command line starts fast.
"""
