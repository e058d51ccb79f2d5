"""The chip of `sculler soc`: flown in Verilator, placed and routed in real parts."""
