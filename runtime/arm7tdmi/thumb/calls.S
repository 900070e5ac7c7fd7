/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* What ravenbrick-processor.adb does in line when the run-time is ARM code. Each subprogram
   starts in Thumb state, so that a call from there needs no veneer. */

#include "layout.h"

        .macro  entered_in_thumb name
        .section .text.\name, "ax"
        .balign 4
        .thumb
        .global \name
        .type   \name, %function
        .thumb_func
\name:  bx      pc
        nop
        .arm
        .endm

        .macro  ends name
        .size   \name, . - \name
        .endm

entered_in_thumb ravenbrick_mask_interrupts
        mrs     r0, cpsr
        orr     r1, r0, #IRQ_MASKED
        msr     cpsr_c, r1
        bx      lr
        ends    ravenbrick_mask_interrupts

entered_in_thumb ravenbrick_set_status
        msr     cpsr_c, r0
        bx      lr
        ends    ravenbrick_set_status

entered_in_thumb ravenbrick_mask_in_thread
        msr     cpsr_c, #(MODE_SYSTEM | IRQ_MASKED)
        bx      lr
        ends    ravenbrick_mask_in_thread

entered_in_thumb ravenbrick_unmask_in_thread
        msr     cpsr_c, #MODE_SYSTEM
        bx      lr
        ends    ravenbrick_unmask_in_thread

/* r0: from, r1: to */
entered_in_thumb ravenbrick_switch
        stmfd   sp!, {r4-r11, lr}
        adr     r3, ravenbrick_switched
        str     r3, [sp, #-4]!
        str     sp, [r0, #THREAD_STACK_POINTER]
        mov     r2, #KERNEL
        str     r1, [r2, #KERNEL_RUNNING]
        str     r1, [r2, #KERNEL_CURRENT]
        ldr     sp, [r1, #THREAD_STACK_POINTER]
        ldr     pc, [sp], #4
        .global ravenbrick_switched
ravenbrick_switched:
        msr     cpsr_c, #MODE_SYSTEM
        ldmfd   sp!, {r4-r11, lr}
        bx      lr
        ends    ravenbrick_switch

/* r0: from */
entered_in_thumb ravenbrick_switch_to_idle
        stmfd   sp!, {r4-r11, lr}
        ldr     r3, =ravenbrick_switched
        str     r3, [sp, #-4]!
        str     sp, [r0, #THREAD_STACK_POINTER]
        b       ravenbrick_idle
        .ltorg
        ends    ravenbrick_switch_to_idle
