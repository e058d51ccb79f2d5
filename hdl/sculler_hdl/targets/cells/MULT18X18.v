// MULT18X18 of Gowin as sculler uses it: one signed 18 x 18 multiplication with all of its
// registers.  It has every input, and of the outputs only the product.
`ifndef SCULLER_MODEL_MULT18X18
`define SCULLER_MODEL_MULT18X18
module MULT18X18 (A, SIA, B, SIB, ASIGN, BSIGN, ASEL, BSEL, CE, CLK, RESET, DOUT);
  parameter AREG = 1'b0;
  parameter BREG = 1'b0;
  parameter OUT_REG = 1'b0;
  parameter PIPE_REG = 1'b0;
  parameter ASIGN_REG = 1'b0;
  parameter BSIGN_REG = 1'b0;
  parameter SOA_REG = 1'b0;
  parameter MULT_RESET_MODE = "SYNC";
  input [17:0] A, SIA, B, SIB;
  input ASIGN, BSIGN, ASEL, BSEL, CE, CLK, RESET;
  output [35:0] DOUT;

  reg signed [17:0] a, b;
  reg signed [35:0] middle, product;
  assign DOUT = product;

  always @(posedge CLK) begin
    if (CE) begin
      a <= A;
      b <= B;
      middle <= a * b;
      product <= middle;
    end
  end

  initial begin
    a = 18'd0;
    b = 18'd0;
    middle = 36'd0;
    product = 36'd0;
  end

  wire for_no_use_here_unused = SOA_REG;

  // what is not modelled must not pass unseen
  initial begin
    if (!(AREG && BREG && OUT_REG && PIPE_REG && ASIGN_REG && BSIGN_REG) ||
        MULT_RESET_MODE != "SYNC") begin
      $display("MULT18X18: this model has every register in use");
      $finish;
    end
  end
  always @(posedge CLK) begin
    if (|{SIA, SIB, ASEL, BSEL, RESET} !== 1'b0 || (ASIGN & BSIGN) !== 1'b1) begin
      $display("MULT18X18: this model is signed, has operands from its ports and is not reset");
      $finish;
    end
  end
endmodule
`endif
