// MULTPREADD18X18 of Lattice Nexus as sculler uses it: one signed 18 x 18 multiplication, with its
// input and output registers; the sum before it adds nothing.
`ifndef SCULLER_MODEL_MULTPREADD18X18
`define SCULLER_MODEL_MULTPREADD18X18
module MULTPREADD18X18 (
  A, B, C, CLK, CEA, RSTA, CEB, RSTB, CEC, RSTC, SIGNEDA, SIGNEDB, SIGNEDC, RSTOUT, CEOUT, Z
);
  parameter REGINPUTA = "REGISTER";
  parameter REGINPUTB = "REGISTER";
  parameter REGINPUTC = "REGISTER";
  parameter REGOUTPUT = "REGISTER";
  parameter GSR = "ENABLED";
  parameter RESETMODE = "SYNC";
  input [17:0] A, B, C;
  input CLK, CEA, RSTA, CEB, RSTB, CEC, RSTC, SIGNEDA, SIGNEDB, SIGNEDC, RSTOUT, CEOUT;
  output [35:0] Z;

  reg signed [17:0] a, b;
  reg signed [35:0] product;
  assign Z = product;

  always @(posedge CLK) begin
    if (CEA) a <= A;
    if (CEB) b <= B;
    if (CEOUT) product <= a * b;
  end

  initial begin
    a = 18'd0;
    b = 18'd0;
    product = 36'd0;
  end

  wire for_no_use_here_unused = CEC && SIGNEDC && GSR == "ENABLED";

  // what is not modelled must not pass unseen
  initial begin
    if (REGINPUTA != "REGISTER" || REGINPUTB != "REGISTER" || REGINPUTC != "REGISTER" ||
        REGOUTPUT != "REGISTER" || RESETMODE != "SYNC") begin
      $display("MULTPREADD18X18: parameters that this model has not");
      $finish;
    end
  end
  always @(posedge CLK) begin
    if (|{C, RSTA, RSTB, RSTC, RSTOUT} !== 1'b0 || (SIGNEDA & SIGNEDB) !== 1'b1) begin
      $display("MULTPREADD18X18: this model is signed, adds nothing and is not reset");
      $finish;
    end
  end
endmodule
`endif
