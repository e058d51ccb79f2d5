/* The first instructions, at address 0: stack, cleared variables, main. */
    .section .start, "ax"
    .global _start
_start:
    la sp, _stack_top
    la tp, _thread          /* the C library's errno lives there */
    la t0, _zero_begin
    la t1, _zero_end
    j cleared
clear:
    sw zero, 0(t0)
    addi t0, t0, 4
cleared:
    bltu t0, t1, clear
    call main
halt:
    j halt
