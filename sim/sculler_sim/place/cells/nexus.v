// PDPSC16K of Lattice Nexus as Yosys infers it: one clock, a write and a read port of the same width,
// 9, 18 or 36 bits, no output register.
module PDPSC16K (DI, ADW, ADR, CLK, CER, CEW, CSW, CSR, RST, DO);
  parameter DATA_WIDTH_W = "X36", DATA_WIDTH_R = "X36", OUTREG = "BYPASSED", RESETMODE = "SYNC";
  parameter GSR = "ENABLED", ECC = "DISABLED", CSDECODE_W = "000", CSDECODE_R = "000";
  parameter ASYNC_RST_RELEASE = "SYNC", INIT_DATA = "STATIC";
  localparam [655:0] ZERO = {"0x", {80{"0"}}};
  // text: 0x and 80 hexadecimal digits, 32 places of 10 bits each, the lower 9 of which are used
  parameter [655:0] INITVAL_00 = ZERO, INITVAL_01 = ZERO, INITVAL_02 = ZERO, INITVAL_03 = ZERO;
  parameter [655:0] INITVAL_04 = ZERO, INITVAL_05 = ZERO, INITVAL_06 = ZERO, INITVAL_07 = ZERO;
  parameter [655:0] INITVAL_08 = ZERO, INITVAL_09 = ZERO, INITVAL_0A = ZERO, INITVAL_0B = ZERO;
  parameter [655:0] INITVAL_0C = ZERO, INITVAL_0D = ZERO, INITVAL_0E = ZERO, INITVAL_0F = ZERO;
  parameter [655:0] INITVAL_10 = ZERO, INITVAL_11 = ZERO, INITVAL_12 = ZERO, INITVAL_13 = ZERO;
  parameter [655:0] INITVAL_14 = ZERO, INITVAL_15 = ZERO, INITVAL_16 = ZERO, INITVAL_17 = ZERO;
  parameter [655:0] INITVAL_18 = ZERO, INITVAL_19 = ZERO, INITVAL_1A = ZERO, INITVAL_1B = ZERO;
  parameter [655:0] INITVAL_1C = ZERO, INITVAL_1D = ZERO, INITVAL_1E = ZERO, INITVAL_1F = ZERO;
  parameter [655:0] INITVAL_20 = ZERO, INITVAL_21 = ZERO, INITVAL_22 = ZERO, INITVAL_23 = ZERO;
  parameter [655:0] INITVAL_24 = ZERO, INITVAL_25 = ZERO, INITVAL_26 = ZERO, INITVAL_27 = ZERO;
  parameter [655:0] INITVAL_28 = ZERO, INITVAL_29 = ZERO, INITVAL_2A = ZERO, INITVAL_2B = ZERO;
  parameter [655:0] INITVAL_2C = ZERO, INITVAL_2D = ZERO, INITVAL_2E = ZERO, INITVAL_2F = ZERO;
  parameter [655:0] INITVAL_30 = ZERO, INITVAL_31 = ZERO, INITVAL_32 = ZERO, INITVAL_33 = ZERO;
  parameter [655:0] INITVAL_34 = ZERO, INITVAL_35 = ZERO, INITVAL_36 = ZERO, INITVAL_37 = ZERO;
  parameter [655:0] INITVAL_38 = ZERO, INITVAL_39 = ZERO, INITVAL_3A = ZERO, INITVAL_3B = ZERO;
  parameter [655:0] INITVAL_3C = ZERO, INITVAL_3D = ZERO, INITVAL_3E = ZERO, INITVAL_3F = ZERO;
  input [35:0] DI;
  input [13:0] ADW, ADR;
  input CLK, CER, CEW, RST;
  input [2:0] CSW, CSR;
  output reg [35:0] DO;

  localparam [41983:0] INITIAL = {
    INITVAL_3F, INITVAL_3E, INITVAL_3D, INITVAL_3C, INITVAL_3B, INITVAL_3A, INITVAL_39, INITVAL_38,
    INITVAL_37, INITVAL_36, INITVAL_35, INITVAL_34, INITVAL_33, INITVAL_32, INITVAL_31, INITVAL_30,
    INITVAL_2F, INITVAL_2E, INITVAL_2D, INITVAL_2C, INITVAL_2B, INITVAL_2A, INITVAL_29, INITVAL_28,
    INITVAL_27, INITVAL_26, INITVAL_25, INITVAL_24, INITVAL_23, INITVAL_22, INITVAL_21, INITVAL_20,
    INITVAL_1F, INITVAL_1E, INITVAL_1D, INITVAL_1C, INITVAL_1B, INITVAL_1A, INITVAL_19, INITVAL_18,
    INITVAL_17, INITVAL_16, INITVAL_15, INITVAL_14, INITVAL_13, INITVAL_12, INITVAL_11, INITVAL_10,
    INITVAL_0F, INITVAL_0E, INITVAL_0D, INITVAL_0C, INITVAL_0B, INITVAL_0A, INITVAL_09, INITVAL_08,
    INITVAL_07, INITVAL_06, INITVAL_05, INITVAL_04, INITVAL_03, INITVAL_02, INITVAL_01, INITVAL_00
  };
  localparam PIECES = DATA_WIDTH_W == "X36" ? 4 : DATA_WIDTH_W == "X18" ? 2 : 1;

  reg [8:0] memory[0:2047];
  integer row, place, digit;
  reg [319:0] bits;
  reg [7:0] c;
  initial begin
    DO = 36'd0;
    for (row = 0; row < 64; row = row + 1) begin
      for (digit = 0; digit < 80; digit = digit + 1) begin
        c = INITIAL[656*row+8*digit+:8];
        bits[4*digit+:4] = c <= "9" ? c - "0" : c <= "F" ? c - "A" + 10 : c - "a" + 10;
      end
      for (place = 0; place < 32; place = place + 1) memory[32*row+place] = bits[10*place+:9];
    end
    if (DATA_WIDTH_W != DATA_WIDTH_R || OUTREG != "BYPASSED" || ECC != "DISABLED" ||
        (DATA_WIDTH_W != "X36" && DATA_WIDTH_W != "X18" && DATA_WIDTH_W != "X9")) begin
      $display("PDPSC16K: parameters that this model has not");
      $finish;
    end
  end

  integer i, j;
  always @(posedge CLK) begin
    if (CER)
      for (i = 0; i < PIECES; i = i + 1) DO[9*i+:9] <= memory[ADR[13:3]/PIECES*PIECES+i];
    if (CEW)
      for (j = 0; j < PIECES; j = j + 1)
        if (PIECES == 1 || ADW[j]) memory[ADW[13:3]/PIECES*PIECES+j] <= DI[9*j+:9];
    if (RST !== 1'b0 || {CSW, CSR} !== 6'o77) begin
      $display("PDPSC16K: this model is always selected and not reset");
      $finish;
    end
  end
endmodule
