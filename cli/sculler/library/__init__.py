"""What `import sculler` gives: arrays, frames and paths in, documented objects out.

- `counts`: whole numbers of any dtype, frames and lists as exact counts.
- `logs`: `Log`, `read_log`, `write_log`; `vectors`: `read_vectors`, `write_vectors`, `compare`.
- `models`: `FastModel`; `hardware`: `generate`, `simulate`.
- `navigating`: `increments`, `navigate`; `live`: `LiveNavigator`.
- `motions`: `motion`, `record`; `studies`: `coning_drift`, `sculling_drift`, `advise`.

It imports `runs`, `formats`, `checks` and the rooms of the model, never `commands` or `terminal`.
This page loads nothing, and each module pandas and polars only where a frame comes or is asked for.
"""
