"""Studies of accuracy, a public module each: closed forms, and the same through the integers.

`closed_form` and `drift` are analytic; `frequency`, `manoeuvre`, `quantisation`, `vibration` and
`triple` study one kind of motion each through the exact integers (`integer_path`); `third_order`
has the terms that two-rate algorithms leave out; `iteration` what the samples themselves allow;
`advice` finds the designs that meet a requirement.  It may import every other room.
"""
