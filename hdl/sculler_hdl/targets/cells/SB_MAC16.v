// SB_MAC16 of the iCE40 UltraPlus as sculler uses it: one signed 16 x 16 multiplication with all of
// its pipeline registers.  It has every input, and of the outputs only the product.
`ifndef SCULLER_MODEL_SB_MAC16
`define SCULLER_MODEL_SB_MAC16
module SB_MAC16 (
  CLK, CE, C, A, B, D, AHOLD, BHOLD, CHOLD, DHOLD, IRSTTOP, IRSTBOT, ORSTTOP, ORSTBOT,
  OLOADTOP, OLOADBOT, ADDSUBTOP, ADDSUBBOT, OHOLDTOP, OHOLDBOT, CI, ACCUMCI, SIGNEXTIN, O
);
  parameter [0:0] A_REG = 1'b1;
  parameter [0:0] B_REG = 1'b1;
  parameter [0:0] TOP_8x8_MULT_REG = 1'b1;
  parameter [0:0] BOT_8x8_MULT_REG = 1'b1;
  parameter [0:0] PIPELINE_16x16_MULT_REG1 = 1'b1;
  parameter [0:0] PIPELINE_16x16_MULT_REG2 = 1'b1;
  parameter [1:0] TOPOUTPUT_SELECT = 2'b11;
  parameter [1:0] BOTOUTPUT_SELECT = 2'b11;
  parameter [0:0] A_SIGNED = 1'b1;
  parameter [0:0] B_SIGNED = 1'b1;
  input CLK, CE;
  input [15:0] C, A, B, D;
  input AHOLD, BHOLD, CHOLD, DHOLD, IRSTTOP, IRSTBOT, ORSTTOP, ORSTBOT;
  input OLOADTOP, OLOADBOT, ADDSUBTOP, ADDSUBBOT, OHOLDTOP, OHOLDBOT, CI, ACCUMCI, SIGNEXTIN;
  output [31:0] O;

  reg signed [15:0] a, b;
  reg signed [31:0] middle, product;
  assign O = product;

  always @(posedge CLK) begin
    if (CE) begin
      a <= A;
      b <= B;
      middle <= a * b;
      product <= middle;
    end
  end

  // what is not modelled must not pass unseen
  initial begin
    if (!(&{A_REG, B_REG, TOP_8x8_MULT_REG, BOT_8x8_MULT_REG, PIPELINE_16x16_MULT_REG1,
            PIPELINE_16x16_MULT_REG2, TOPOUTPUT_SELECT, BOTOUTPUT_SELECT, A_SIGNED, B_SIGNED})) begin
      $display("SB_MAC16: this model is signed with every register in use");
      $finish;
    end
  end
  always @(posedge CLK) begin
    if (|{C, D, AHOLD, BHOLD, CHOLD, DHOLD, IRSTTOP, IRSTBOT, ORSTTOP, ORSTBOT, OLOADTOP, OLOADBOT,
          ADDSUBTOP, ADDSUBBOT, OHOLDTOP, OHOLDBOT, CI, ACCUMCI, SIGNEXTIN} !== 1'b0) begin
      $display("SB_MAC16: this model has all inputs but the operands, CLK and CE at 0");
      $finish;
    end
  end
endmodule
`endif
