/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* The idle loop and the start of threads */

#include "layout.h"

        .arm
        .section .text.ravenbrick_idle, "ax"

/* Interrupts are masked. The interrupt that makes a thread ready leaves the loop by dispatching
   it; nothing of the loop's own context is kept. */
        .global ravenbrick_idle
        .type   ravenbrick_idle, %function
ravenbrick_idle:
        mov     r0, #0
        mov     r1, #KERNEL
        add     r2, r1, #KERNEL_IDLE
        str     r2, [r1, #KERNEL_CURRENT]
        str     r0, [r1, #KERNEL_RUNNING]
        mov     r1, #1
        msr     cpsr_c, #MODE_SYSTEM
1:      str     r1, [r0, #PMC_SCDR]     /* the processor clock stops until an interrupt */
        b       1b
        .size   ravenbrick_idle, . - ravenbrick_idle

/* On the stack: argument, code */
        .global ravenbrick_thread_start
        .type   ravenbrick_thread_start, %function
ravenbrick_thread_start:
        msr     cpsr_c, #MODE_SYSTEM
        ldmfd   sp!, {r0, r4}
        mov     lr, pc
        bx      r4
        b       ravenbrick_terminate
        .size   ravenbrick_thread_start, . - ravenbrick_thread_start
