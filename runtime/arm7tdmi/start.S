/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* The way from the entry point to the main procedure */

#include "layout.h"

        .arm
/* Supervisor mode, interrupts masked by us; the loader's stack is not used */
#define NO_MEMORY 0x00800000

        .section .text.start, "ax"
        .global ravenbrick_reset
        .type   ravenbrick_reset, %function
ravenbrick_reset:
        msr     cpsr_c, #(MODE_FIQ | ALL_MASKED)
        mov     sp, #NO_MEMORY          /* see interrupt.S */
        msr     cpsr_c, #(MODE_IRQ | IRQ_MASKED)
        ldr     sp, =ravenbrick_interrupt_stack_top
        msr     cpsr_c, #(MODE_SUPERVISOR | IRQ_MASKED)
        ldr     sp, =ravenbrick_handler_stack_top
        msr     cpsr_c, #(MODE_SYSTEM | IRQ_MASKED)
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
        .size   ravenbrick_reset, . - ravenbrick_reset

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
