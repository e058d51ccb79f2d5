// MULT18X18D of the ECP5 with its registers as the parameters say, each on CLK0 or left out.
// It has every input but SRIA and SRIB, which only a neighbour's SROA and SROB can feed and which
// SOURCEA = SOURCEB = 0 turns off; and of the outputs only the product.
`ifndef SCULLER_MODEL_MULT18X18D
`define SCULLER_MODEL_MULT18X18D
module MULT18X18D (
  CLK0, CLK1, CLK2, CLK3, CE0, CE1, CE2, CE3, RST0, RST1, RST2, RST3,
  SIGNEDA, SIGNEDB, SOURCEA, SOURCEB,
  A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0,
  B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0,
  C17, C16, C15, C14, C13, C12, C11, C10, C9, C8, C7, C6, C5, C4, C3, C2, C1, C0,
  P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17,
    P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0
);
  parameter REG_INPUTA_CLK = "NONE", REG_INPUTA_CE = "CE0", REG_INPUTA_RST = "RST0";
  parameter REG_INPUTB_CLK = "NONE", REG_INPUTB_CE = "CE0", REG_INPUTB_RST = "RST0";
  parameter REG_INPUTC_CLK = "NONE", REG_INPUTC_CE = "CE0", REG_INPUTC_RST = "RST0";
  parameter REG_PIPELINE_CLK = "NONE", REG_PIPELINE_CE = "CE0", REG_PIPELINE_RST = "RST0";
  parameter REG_OUTPUT_CLK = "NONE", REG_OUTPUT_CE = "CE0", REG_OUTPUT_RST = "RST0";
  parameter CLK0_DIV = "ENABLED", CLK1_DIV = "ENABLED", CLK2_DIV = "ENABLED", CLK3_DIV = "ENABLED";
  parameter HIGHSPEED_CLK = "NONE", GSR = "ENABLED", CAS_MATCH_REG = "FALSE";
  parameter SOURCEB_MODE = "B_SHIFT", MULT_BYPASS = "DISABLED", RESETMODE = "SYNC";
  input CLK0, CLK1, CLK2, CLK3, CE0, CE1, CE2, CE3, RST0, RST1, RST2, RST3;
  input SIGNEDA, SIGNEDB, SOURCEA, SOURCEB;
  input A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0;
  input B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0;
  input C17, C16, C15, C14, C13, C12, C11, C10, C9, C8, C7, C6, C5, C4, C3, C2, C1, C0;
  output P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18,
    P17, P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0;

  // each operand with its sign, and how both are signed, which goes through the registers with them
  wire [18:0] a_in = {SIGNEDA & A17,
    A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0};
  wire [18:0] b_in = {SIGNEDB & B17,
    B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0};
  reg [18:0] a_reg;
  reg [18:0] b_reg;
  wire signed [18:0] a = REG_INPUTA_CLK == "NONE" ? a_in : a_reg;
  wire signed [18:0] b = REG_INPUTB_CLK == "NONE" ? b_in : b_reg;
  wire signed [37:0] product = a * b;
  reg [37:0] middle_reg;
  wire [37:0] middle = REG_PIPELINE_CLK == "NONE" ? product : middle_reg;
  reg [37:0] output_reg;
  wire [37:0] p_unused_above = REG_OUTPUT_CLK == "NONE" ? middle : output_reg;
  assign {
    P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17,
    P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0
  } = p_unused_above[35:0];

  always @(posedge CLK0) begin
    if (RST0) begin
      a_reg <= 0;
      b_reg <= 0;
      middle_reg <= 0;
      output_reg <= 0;
    end else if (CE0) begin
      a_reg <= a_in;
      b_reg <= b_in;
      middle_reg <= product;
      output_reg <= middle;
    end
  end

  initial begin
    a_reg = 0;
    b_reg = 0;
    middle_reg = 0;
    output_reg = 0;
  end

  wire [35:0] for_no_use_here_unused = {
    REG_INPUTC_CLK == "NONE", REG_INPUTC_CE == "CE0", REG_INPUTC_RST == "RST0",
    CLK0_DIV == "ENABLED", CLK1_DIV == "ENABLED", CLK2_DIV == "ENABLED", CLK3_DIV == "ENABLED",
    HIGHSPEED_CLK == "NONE", GSR == "ENABLED",
    C17, C16, C15, C14, C13, C12, C11, C10, C9, C8, C7, C6, C5, C4, C3, C2, C1, C0,
    CLK1, CLK2, CLK3, CE1, CE2, CE3, RST1, RST2, RST3
  };

  // what is not modelled must not pass unseen
  initial begin
    if (SOURCEB_MODE != "B_SHIFT" || MULT_BYPASS != "DISABLED" || RESETMODE != "SYNC" ||
        CAS_MATCH_REG != "FALSE" ||
        (REG_INPUTA_CLK != "NONE" && REG_INPUTA_CLK != "CLK0") ||
        (REG_INPUTB_CLK != "NONE" && REG_INPUTB_CLK != "CLK0") ||
        (REG_PIPELINE_CLK != "NONE" && REG_PIPELINE_CLK != "CLK0") ||
        (REG_OUTPUT_CLK != "NONE" && REG_OUTPUT_CLK != "CLK0") ||
        REG_INPUTA_CE != "CE0" || REG_INPUTB_CE != "CE0" || REG_PIPELINE_CE != "CE0" ||
        REG_OUTPUT_CE != "CE0" || REG_INPUTA_RST != "RST0" || REG_INPUTB_RST != "RST0" ||
        REG_PIPELINE_RST != "RST0" || REG_OUTPUT_RST != "RST0") begin
      $display("MULT18X18D: parameters that this model has not");
      $finish;
    end
  end
  always @(posedge CLK0) begin
    if (SOURCEA !== 1'b0 || SOURCEB !== 1'b0) begin
      $display("MULT18X18D: this model has operands from its A and B ports");
      $finish;
    end
  end
endmodule
`endif
