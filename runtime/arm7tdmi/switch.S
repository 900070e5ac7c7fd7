/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* Exchange of thread contexts. A saved context is r4 to r11 and the return address on the
   thread's own stack, whose pointer the control block keeps. Interrupts are masked on entry and
   unmasked when the thread goes on. */

#include "layout.h"

        .arm
        .section .text.ravenbrick_switch, "ax"

/* r0: control block of the running thread; r1: of the next, first of the ready queue or not in
   it; r2: kernel */
        .global ravenbrick_switch
        .type   ravenbrick_switch, %function
ravenbrick_switch:
        stmfd   sp!, {r4-r11, lr}
        str     sp, [r0, #THREAD_STACK_POINTER]
        str     r1, [r2, #KERNEL_RUNNING]
        str     r1, [r2, #KERNEL_CURRENT]
        ldr     sp, [r1, #THREAD_STACK_POINTER]
        ldmfd   sp!, {r4-r11, lr}
        msr     cpsr_c, #MODE_SYSTEM
        bx      lr
        .size   ravenbrick_switch, . - ravenbrick_switch

/* r0: control block of the running thread; r1: kernel. The interrupt that makes a thread ready
   leaves the idle loop by dispatching it; nothing of the loop's own context is kept. */
        .global ravenbrick_switch_to_idle
        .type   ravenbrick_switch_to_idle, %function
ravenbrick_switch_to_idle:
        stmfd   sp!, {r4-r11, lr}
        str     sp, [r0, #THREAD_STACK_POINTER]
        mov     r0, #0
        add     r2, r1, #KERNEL_IDLE
        str     r2, [r1, #KERNEL_CURRENT]
        str     r0, [r1, #KERNEL_RUNNING]
        mov     r1, #1
        msr     cpsr_c, #MODE_SYSTEM
1:      str     r1, [r0, #PMC_SCDR]     /* the processor clock stops until an interrupt */
        b       1b
        .size   ravenbrick_switch_to_idle, . - ravenbrick_switch_to_idle

/* First return address of a thread: r4 is its code, r5 its argument */
        .global ravenbrick_thread_start
        .type   ravenbrick_thread_start, %function
ravenbrick_thread_start:
        mov     r0, r5
        mov     lr, pc
        bx      r4
        b       ravenbrick_terminate
        .size   ravenbrick_thread_start, . - ravenbrick_thread_start
