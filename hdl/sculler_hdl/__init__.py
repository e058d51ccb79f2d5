"""What becomes gates: the integer coning/sculling core in Amaranth, and its Verilog."""
