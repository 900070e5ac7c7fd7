/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* Exception vectors, the first of which is the entry point, and the way from the entry point to the main procedure */

#include "layout.h"

        .arm
        .section .vectors, "ax"
        .global _start, ravenbrick_vectors
_start:
ravenbrick_vectors:
        ldr     pc, 1f
        ldr     pc, 1f + 4
        ldr     pc, 1f + 8
        ldr     pc, 1f + 12
        ldr     pc, 1f + 16
        nop
        ldr     pc, 1f + 24
        ldr     pc, 1f + 28
1:      .word   reset
        .word   undefined_instruction
        .word   software_interrupt
        .word   prefetch_abort
        .word   data_abort
        .word   0
        .word   ravenbrick_interrupt
        .word   fast_interrupt
        .global ravenbrick_vectors_end
ravenbrick_vectors_end:

/* Supervisor mode, interrupts masked by us; the loader's stack is not used */
        .section .text.start, "ax"
reset:  msr     cpsr_c, #(MODE_IRQ | ALL_MASKED)
        ldr     sp, =ravenbrick_interrupt_stack_top
        msr     cpsr_c, #(MODE_SUPERVISOR | ALL_MASKED)
        ldr     sp, =ravenbrick_handler_stack_top
        msr     cpsr_c, #(MODE_SYSTEM | ALL_MASKED)
        ldr     sp, =ravenbrick_environment_stack_top

        bl      ravenbrick_start_board  /* first: power-on runs at 32 kHz */
        ldr     r0, =ravenbrick_low_zero
        ldr     r1, =ravenbrick_low_zero_end
        bl      clear
        ldr     r0, =ravenbrick_vectors_run
        ldr     r1, =ravenbrick_vectors
        ldr     r2, =ravenbrick_vectors_run_end
        bl      copy
        ldr     r0, =ravenbrick_data
        ldr     r1, =ravenbrick_data_load
        ldr     r2, =ravenbrick_data_end
        bl      copy
        ldr     r0, =ravenbrick_bss
        ldr     r1, =ravenbrick_bss_end
        bl      clear

        bl      ravenbrick_initialize_interrupts
        bl      ravenbrick_initialize_threads
        bl      ravenbrick_start_clock
        bl      ravenbrick_start_alarm
        msr     cpsr_c, #MODE_SYSTEM
        bl      main
        b       ravenbrick_terminate

/* words from r1 to r0 until r0 = r2, unless they are there already */
copy:   cmp     r0, r1
        bxeq    lr
1:      cmp     r0, r2
        ldrlo   r3, [r1], #4
        strlo   r3, [r0], #4
        blo     1b
        bx      lr

/* zeros from r0 to r1 */
clear:  mov     r2, #0
1:      cmp     r0, r1
        strlo   r2, [r0], #4
        blo     1b
        bx      lr
