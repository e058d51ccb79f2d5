// MULT18X18D of the ECP5 as sculler uses it: signed operands from the A and B ports, all four
// registers on CLK0, CE0 and RST0.
module MULT18X18D (
  CLK0, CE0, RST0, SIGNEDA, SIGNEDB, SOURCEA, SOURCEB,
  A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0,
  B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0,
  P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17,
    P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0
);
  parameter REG_INPUTA_CLK = "CLK0";
  parameter REG_INPUTB_CLK = "CLK0";
  parameter REG_PIPELINE_CLK = "CLK0";
  parameter REG_OUTPUT_CLK = "CLK0";
  input CLK0, CE0, RST0, SIGNEDA, SIGNEDB, SOURCEA, SOURCEB;
  input A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0;
  input B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0;
  output P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18,
    P17, P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0;

  wire [17:0] a_in = {
    A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0
  };
  wire [17:0] b_in = {
    B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0
  };
  reg signed [17:0] a;
  reg signed [17:0] b;
  reg signed [35:0] middle;
  reg signed [35:0] product;
  assign {
    P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17,
    P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0
  } = product;

  always @(posedge CLK0) begin
    if (RST0) begin
      a <= 18'd0;
      b <= 18'd0;
      middle <= 36'd0;
      product <= 36'd0;
    end else if (CE0) begin
      a <= a_in;
      b <= b_in;
      middle <= a * b;
      product <= middle;
    end
  end

  // what is not modelled must not pass unseen
  initial begin
    if (REG_INPUTA_CLK != "CLK0" || REG_INPUTB_CLK != "CLK0" ||
        REG_PIPELINE_CLK != "CLK0" || REG_OUTPUT_CLK != "CLK0") begin
      $display("MULT18X18D: this model has every register on CLK0");
      $finish;
    end
  end
  always @(posedge CLK0) begin
    if (!SIGNEDA || !SIGNEDB || SOURCEA || SOURCEB) begin
      $display("MULT18X18D: this model has signed operands from its A and B ports");
      $finish;
    end
  end
endmodule
