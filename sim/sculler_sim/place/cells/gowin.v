// Block memories of Gowin as Yosys infers them: 9, 18 or 36 bits, no output register.  GOWIN_MEMORY is
// ours: two ports of the same width; a port that writes shows nothing (mode 0), what it writes (1) or
// what was there before (2).
module GOWIN_MEMORY (clka, cea, wrea, ada, dia, doa, clkb, ceb, wreb, adb, dib, dob, idle);
  parameter WIDTH = 36, MODE_A = 0, MODE_B = 0;
  parameter [18431:0] INITIAL = 18432'd0;
  input clka, cea, wrea, clkb, ceb, wreb, idle;
  input [13:0] ada, adb;
  input [35:0] dia, dib;
  output reg [35:0] doa, dob;
  localparam PIECES = WIDTH / 9;

  reg [8:0] memory[0:2047];
  integer place;
  initial begin
    doa = 36'd0;
    dob = 36'd0;
    for (place = 0; place < 2048; place = place + 1) memory[place] = INITIAL[9*place+:9];
    if (WIDTH != 9 && WIDTH != 18 && WIDTH != 36) begin
      $display("Gowin's block memory: a width that this model has not");
      $finish;
    end
  end

  integer i, j;
  always @(posedge clka) begin
    for (i = 0; i < PIECES; i = i + 1) begin
      if (cea && wrea && (PIECES == 1 || ada[i]))
        memory[ada[13:3]/PIECES*PIECES+i] <= dia[9*i+:9];
      if (cea && (!wrea || MODE_A == 2)) doa[9*i+:9] <= memory[ada[13:3]/PIECES*PIECES+i];
      if (cea && wrea && MODE_A == 1) doa[9*i+:9] <= dia[9*i+:9];
    end
    if (idle !== 1'b1) begin
      $display("Gowin's block memory: this model is always selected and not reset");
      $finish;
    end
  end
  always @(posedge clkb) begin
    for (j = 0; j < PIECES; j = j + 1) begin
      if (ceb && wreb && (PIECES == 1 || adb[j]))
        memory[adb[13:3]/PIECES*PIECES+j] <= dib[9*j+:9];
      if (ceb && (!wreb || MODE_B == 2)) dob[9*j+:9] <= memory[adb[13:3]/PIECES*PIECES+j];
      if (ceb && wreb && MODE_B == 1) dob[9*j+:9] <= dib[9*j+:9];
    end
  end
endmodule

module SPX9 (CLK, CE, OCE, RESET, WRE, AD, BLKSEL, DI, DO);
  parameter READ_MODE = 1'b0, WRITE_MODE = 2'b00, BIT_WIDTH = 36, BLK_SEL = 3'b000;
  parameter RESET_MODE = "SYNC";
  parameter [287:0] INIT_RAM_00 = 288'd0, INIT_RAM_01 = 288'd0, INIT_RAM_02 = 288'd0, INIT_RAM_03 = 288'd0;
  parameter [287:0] INIT_RAM_04 = 288'd0, INIT_RAM_05 = 288'd0, INIT_RAM_06 = 288'd0, INIT_RAM_07 = 288'd0;
  parameter [287:0] INIT_RAM_08 = 288'd0, INIT_RAM_09 = 288'd0, INIT_RAM_0A = 288'd0, INIT_RAM_0B = 288'd0;
  parameter [287:0] INIT_RAM_0C = 288'd0, INIT_RAM_0D = 288'd0, INIT_RAM_0E = 288'd0, INIT_RAM_0F = 288'd0;
  parameter [287:0] INIT_RAM_10 = 288'd0, INIT_RAM_11 = 288'd0, INIT_RAM_12 = 288'd0, INIT_RAM_13 = 288'd0;
  parameter [287:0] INIT_RAM_14 = 288'd0, INIT_RAM_15 = 288'd0, INIT_RAM_16 = 288'd0, INIT_RAM_17 = 288'd0;
  parameter [287:0] INIT_RAM_18 = 288'd0, INIT_RAM_19 = 288'd0, INIT_RAM_1A = 288'd0, INIT_RAM_1B = 288'd0;
  parameter [287:0] INIT_RAM_1C = 288'd0, INIT_RAM_1D = 288'd0, INIT_RAM_1E = 288'd0, INIT_RAM_1F = 288'd0;
  parameter [287:0] INIT_RAM_20 = 288'd0, INIT_RAM_21 = 288'd0, INIT_RAM_22 = 288'd0, INIT_RAM_23 = 288'd0;
  parameter [287:0] INIT_RAM_24 = 288'd0, INIT_RAM_25 = 288'd0, INIT_RAM_26 = 288'd0, INIT_RAM_27 = 288'd0;
  parameter [287:0] INIT_RAM_28 = 288'd0, INIT_RAM_29 = 288'd0, INIT_RAM_2A = 288'd0, INIT_RAM_2B = 288'd0;
  parameter [287:0] INIT_RAM_2C = 288'd0, INIT_RAM_2D = 288'd0, INIT_RAM_2E = 288'd0, INIT_RAM_2F = 288'd0;
  parameter [287:0] INIT_RAM_30 = 288'd0, INIT_RAM_31 = 288'd0, INIT_RAM_32 = 288'd0, INIT_RAM_33 = 288'd0;
  parameter [287:0] INIT_RAM_34 = 288'd0, INIT_RAM_35 = 288'd0, INIT_RAM_36 = 288'd0, INIT_RAM_37 = 288'd0;
  parameter [287:0] INIT_RAM_38 = 288'd0, INIT_RAM_39 = 288'd0, INIT_RAM_3A = 288'd0, INIT_RAM_3B = 288'd0;
  parameter [287:0] INIT_RAM_3C = 288'd0, INIT_RAM_3D = 288'd0, INIT_RAM_3E = 288'd0, INIT_RAM_3F = 288'd0;
  input CLK, CE, OCE, RESET, WRE;
  input [13:0] AD;
  input [2:0] BLKSEL;
  input [35:0] DI;
  output [35:0] DO;

  wire idle = ~|{READ_MODE, BLK_SEL, BLKSEL, RESET};
  wire [35:0] unused;
  localparam [18431:0] INITIAL = {
    INIT_RAM_3F, INIT_RAM_3E, INIT_RAM_3D, INIT_RAM_3C, INIT_RAM_3B, INIT_RAM_3A, INIT_RAM_39, INIT_RAM_38,
    INIT_RAM_37, INIT_RAM_36, INIT_RAM_35, INIT_RAM_34, INIT_RAM_33, INIT_RAM_32, INIT_RAM_31, INIT_RAM_30,
    INIT_RAM_2F, INIT_RAM_2E, INIT_RAM_2D, INIT_RAM_2C, INIT_RAM_2B, INIT_RAM_2A, INIT_RAM_29, INIT_RAM_28,
    INIT_RAM_27, INIT_RAM_26, INIT_RAM_25, INIT_RAM_24, INIT_RAM_23, INIT_RAM_22, INIT_RAM_21, INIT_RAM_20,
    INIT_RAM_1F, INIT_RAM_1E, INIT_RAM_1D, INIT_RAM_1C, INIT_RAM_1B, INIT_RAM_1A, INIT_RAM_19, INIT_RAM_18,
    INIT_RAM_17, INIT_RAM_16, INIT_RAM_15, INIT_RAM_14, INIT_RAM_13, INIT_RAM_12, INIT_RAM_11, INIT_RAM_10,
    INIT_RAM_0F, INIT_RAM_0E, INIT_RAM_0D, INIT_RAM_0C, INIT_RAM_0B, INIT_RAM_0A, INIT_RAM_09, INIT_RAM_08,
    INIT_RAM_07, INIT_RAM_06, INIT_RAM_05, INIT_RAM_04, INIT_RAM_03, INIT_RAM_02, INIT_RAM_01, INIT_RAM_00
  };
  GOWIN_MEMORY #(
    .WIDTH(BIT_WIDTH), .MODE_A(WRITE_MODE), .INITIAL(INITIAL)
  ) memory (
    .clka(CLK), .cea(CE), .wrea(WRE), .ada(AD), .dia(DI), .doa(DO),
    .clkb(CLK), .ceb(1'b0), .wreb(1'b0), .adb(14'd0), .dib(36'd0), .dob(unused), .idle(idle)
  );
endmodule

module DPX9B (
  CLKA, CEA, OCEA, RESETA, WREA, ADA, BLKSELA, DIA, DOA,
  CLKB, CEB, OCEB, RESETB, WREB, ADB, BLKSELB, DIB, DOB
);
  parameter READ_MODE0 = 1'b0, READ_MODE1 = 1'b0, WRITE_MODE0 = 2'b00, WRITE_MODE1 = 2'b00;
  parameter BIT_WIDTH_0 = 18, BIT_WIDTH_1 = 18, BLK_SEL_0 = 3'b000, BLK_SEL_1 = 3'b000;
  parameter RESET_MODE = "SYNC";
  parameter [287:0] INIT_RAM_00 = 288'd0, INIT_RAM_01 = 288'd0, INIT_RAM_02 = 288'd0, INIT_RAM_03 = 288'd0;
  parameter [287:0] INIT_RAM_04 = 288'd0, INIT_RAM_05 = 288'd0, INIT_RAM_06 = 288'd0, INIT_RAM_07 = 288'd0;
  parameter [287:0] INIT_RAM_08 = 288'd0, INIT_RAM_09 = 288'd0, INIT_RAM_0A = 288'd0, INIT_RAM_0B = 288'd0;
  parameter [287:0] INIT_RAM_0C = 288'd0, INIT_RAM_0D = 288'd0, INIT_RAM_0E = 288'd0, INIT_RAM_0F = 288'd0;
  parameter [287:0] INIT_RAM_10 = 288'd0, INIT_RAM_11 = 288'd0, INIT_RAM_12 = 288'd0, INIT_RAM_13 = 288'd0;
  parameter [287:0] INIT_RAM_14 = 288'd0, INIT_RAM_15 = 288'd0, INIT_RAM_16 = 288'd0, INIT_RAM_17 = 288'd0;
  parameter [287:0] INIT_RAM_18 = 288'd0, INIT_RAM_19 = 288'd0, INIT_RAM_1A = 288'd0, INIT_RAM_1B = 288'd0;
  parameter [287:0] INIT_RAM_1C = 288'd0, INIT_RAM_1D = 288'd0, INIT_RAM_1E = 288'd0, INIT_RAM_1F = 288'd0;
  parameter [287:0] INIT_RAM_20 = 288'd0, INIT_RAM_21 = 288'd0, INIT_RAM_22 = 288'd0, INIT_RAM_23 = 288'd0;
  parameter [287:0] INIT_RAM_24 = 288'd0, INIT_RAM_25 = 288'd0, INIT_RAM_26 = 288'd0, INIT_RAM_27 = 288'd0;
  parameter [287:0] INIT_RAM_28 = 288'd0, INIT_RAM_29 = 288'd0, INIT_RAM_2A = 288'd0, INIT_RAM_2B = 288'd0;
  parameter [287:0] INIT_RAM_2C = 288'd0, INIT_RAM_2D = 288'd0, INIT_RAM_2E = 288'd0, INIT_RAM_2F = 288'd0;
  parameter [287:0] INIT_RAM_30 = 288'd0, INIT_RAM_31 = 288'd0, INIT_RAM_32 = 288'd0, INIT_RAM_33 = 288'd0;
  parameter [287:0] INIT_RAM_34 = 288'd0, INIT_RAM_35 = 288'd0, INIT_RAM_36 = 288'd0, INIT_RAM_37 = 288'd0;
  parameter [287:0] INIT_RAM_38 = 288'd0, INIT_RAM_39 = 288'd0, INIT_RAM_3A = 288'd0, INIT_RAM_3B = 288'd0;
  parameter [287:0] INIT_RAM_3C = 288'd0, INIT_RAM_3D = 288'd0, INIT_RAM_3E = 288'd0, INIT_RAM_3F = 288'd0;
  input CLKA, CEA, OCEA, RESETA, WREA, CLKB, CEB, OCEB, RESETB, WREB;
  input [13:0] ADA, ADB;
  input [2:0] BLKSELA, BLKSELB;
  input [17:0] DIA, DIB;
  output [17:0] DOA, DOB;

  wire idle = ~|{READ_MODE0, READ_MODE1, BLK_SEL_0, BLK_SEL_1,
                 BLKSELA, BLKSELB, RESETA, RESETB} & BIT_WIDTH_0 == BIT_WIDTH_1;
  wire [35:0] shown_a, shown_b;
  assign DOA = shown_a[17:0];
  assign DOB = shown_b[17:0];
  localparam [18431:0] INITIAL = {
    INIT_RAM_3F, INIT_RAM_3E, INIT_RAM_3D, INIT_RAM_3C, INIT_RAM_3B, INIT_RAM_3A, INIT_RAM_39, INIT_RAM_38,
    INIT_RAM_37, INIT_RAM_36, INIT_RAM_35, INIT_RAM_34, INIT_RAM_33, INIT_RAM_32, INIT_RAM_31, INIT_RAM_30,
    INIT_RAM_2F, INIT_RAM_2E, INIT_RAM_2D, INIT_RAM_2C, INIT_RAM_2B, INIT_RAM_2A, INIT_RAM_29, INIT_RAM_28,
    INIT_RAM_27, INIT_RAM_26, INIT_RAM_25, INIT_RAM_24, INIT_RAM_23, INIT_RAM_22, INIT_RAM_21, INIT_RAM_20,
    INIT_RAM_1F, INIT_RAM_1E, INIT_RAM_1D, INIT_RAM_1C, INIT_RAM_1B, INIT_RAM_1A, INIT_RAM_19, INIT_RAM_18,
    INIT_RAM_17, INIT_RAM_16, INIT_RAM_15, INIT_RAM_14, INIT_RAM_13, INIT_RAM_12, INIT_RAM_11, INIT_RAM_10,
    INIT_RAM_0F, INIT_RAM_0E, INIT_RAM_0D, INIT_RAM_0C, INIT_RAM_0B, INIT_RAM_0A, INIT_RAM_09, INIT_RAM_08,
    INIT_RAM_07, INIT_RAM_06, INIT_RAM_05, INIT_RAM_04, INIT_RAM_03, INIT_RAM_02, INIT_RAM_01, INIT_RAM_00
  };
  GOWIN_MEMORY #(
    .WIDTH(BIT_WIDTH_0), .MODE_A(WRITE_MODE0), .MODE_B(WRITE_MODE1), .INITIAL(INITIAL)
  ) memory (
    .clka(CLKA), .cea(CEA), .wrea(WREA), .ada(ADA), .dia({18'd0, DIA}), .doa(shown_a),
    .clkb(CLKB), .ceb(CEB), .wreb(WREB), .adb(ADB), .dib({18'd0, DIB}), .dob(shown_b),
    .idle(idle)
  );
endmodule

module SDPX9B (CLKA, CEA, CLKB, CEB, OCE, RESETA, RESETB, ADA, ADB, BLKSELA, BLKSELB, DI, DO);
  parameter READ_MODE = 1'b0, BIT_WIDTH_0 = 36, BIT_WIDTH_1 = 36;
  parameter BLK_SEL_0 = 3'b000, BLK_SEL_1 = 3'b000, RESET_MODE = "SYNC";
  parameter [287:0] INIT_RAM_00 = 288'd0, INIT_RAM_01 = 288'd0, INIT_RAM_02 = 288'd0, INIT_RAM_03 = 288'd0;
  parameter [287:0] INIT_RAM_04 = 288'd0, INIT_RAM_05 = 288'd0, INIT_RAM_06 = 288'd0, INIT_RAM_07 = 288'd0;
  parameter [287:0] INIT_RAM_08 = 288'd0, INIT_RAM_09 = 288'd0, INIT_RAM_0A = 288'd0, INIT_RAM_0B = 288'd0;
  parameter [287:0] INIT_RAM_0C = 288'd0, INIT_RAM_0D = 288'd0, INIT_RAM_0E = 288'd0, INIT_RAM_0F = 288'd0;
  parameter [287:0] INIT_RAM_10 = 288'd0, INIT_RAM_11 = 288'd0, INIT_RAM_12 = 288'd0, INIT_RAM_13 = 288'd0;
  parameter [287:0] INIT_RAM_14 = 288'd0, INIT_RAM_15 = 288'd0, INIT_RAM_16 = 288'd0, INIT_RAM_17 = 288'd0;
  parameter [287:0] INIT_RAM_18 = 288'd0, INIT_RAM_19 = 288'd0, INIT_RAM_1A = 288'd0, INIT_RAM_1B = 288'd0;
  parameter [287:0] INIT_RAM_1C = 288'd0, INIT_RAM_1D = 288'd0, INIT_RAM_1E = 288'd0, INIT_RAM_1F = 288'd0;
  parameter [287:0] INIT_RAM_20 = 288'd0, INIT_RAM_21 = 288'd0, INIT_RAM_22 = 288'd0, INIT_RAM_23 = 288'd0;
  parameter [287:0] INIT_RAM_24 = 288'd0, INIT_RAM_25 = 288'd0, INIT_RAM_26 = 288'd0, INIT_RAM_27 = 288'd0;
  parameter [287:0] INIT_RAM_28 = 288'd0, INIT_RAM_29 = 288'd0, INIT_RAM_2A = 288'd0, INIT_RAM_2B = 288'd0;
  parameter [287:0] INIT_RAM_2C = 288'd0, INIT_RAM_2D = 288'd0, INIT_RAM_2E = 288'd0, INIT_RAM_2F = 288'd0;
  parameter [287:0] INIT_RAM_30 = 288'd0, INIT_RAM_31 = 288'd0, INIT_RAM_32 = 288'd0, INIT_RAM_33 = 288'd0;
  parameter [287:0] INIT_RAM_34 = 288'd0, INIT_RAM_35 = 288'd0, INIT_RAM_36 = 288'd0, INIT_RAM_37 = 288'd0;
  parameter [287:0] INIT_RAM_38 = 288'd0, INIT_RAM_39 = 288'd0, INIT_RAM_3A = 288'd0, INIT_RAM_3B = 288'd0;
  parameter [287:0] INIT_RAM_3C = 288'd0, INIT_RAM_3D = 288'd0, INIT_RAM_3E = 288'd0, INIT_RAM_3F = 288'd0;
  input CLKA, CEA, CLKB, CEB, OCE, RESETA, RESETB;
  input [13:0] ADA, ADB;
  input [2:0] BLKSELA, BLKSELB;
  input [35:0] DI;
  output [35:0] DO;

  wire idle = ~|{READ_MODE, BLK_SEL_0, BLK_SEL_1, BLKSELA, BLKSELB, RESETA, RESETB} &
              BIT_WIDTH_0 == BIT_WIDTH_1;
  wire [35:0] unused;
  localparam [18431:0] INITIAL = {
    INIT_RAM_3F, INIT_RAM_3E, INIT_RAM_3D, INIT_RAM_3C, INIT_RAM_3B, INIT_RAM_3A, INIT_RAM_39, INIT_RAM_38,
    INIT_RAM_37, INIT_RAM_36, INIT_RAM_35, INIT_RAM_34, INIT_RAM_33, INIT_RAM_32, INIT_RAM_31, INIT_RAM_30,
    INIT_RAM_2F, INIT_RAM_2E, INIT_RAM_2D, INIT_RAM_2C, INIT_RAM_2B, INIT_RAM_2A, INIT_RAM_29, INIT_RAM_28,
    INIT_RAM_27, INIT_RAM_26, INIT_RAM_25, INIT_RAM_24, INIT_RAM_23, INIT_RAM_22, INIT_RAM_21, INIT_RAM_20,
    INIT_RAM_1F, INIT_RAM_1E, INIT_RAM_1D, INIT_RAM_1C, INIT_RAM_1B, INIT_RAM_1A, INIT_RAM_19, INIT_RAM_18,
    INIT_RAM_17, INIT_RAM_16, INIT_RAM_15, INIT_RAM_14, INIT_RAM_13, INIT_RAM_12, INIT_RAM_11, INIT_RAM_10,
    INIT_RAM_0F, INIT_RAM_0E, INIT_RAM_0D, INIT_RAM_0C, INIT_RAM_0B, INIT_RAM_0A, INIT_RAM_09, INIT_RAM_08,
    INIT_RAM_07, INIT_RAM_06, INIT_RAM_05, INIT_RAM_04, INIT_RAM_03, INIT_RAM_02, INIT_RAM_01, INIT_RAM_00
  };
  GOWIN_MEMORY #(
    .WIDTH(BIT_WIDTH_0), .INITIAL(INITIAL)
  ) memory (
    .clka(CLKA), .cea(CEA), .wrea(CEA), .ada(ADA), .dia(DI), .doa(unused),
    .clkb(CLKB), .ceb(CEB), .wreb(1'b0), .adb(ADB), .dib(36'd0), .dob(DO), .idle(idle)
  );
endmodule
