"""From a design to files: the Verilog text and the manifest that describes it."""
