/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* What the kernel's contracts ask the processor; only an image that checks them has it */

        .section .text.ravenbrick_interrupts_masked, "ax"
        .balign 4
        .arm
        .global ravenbrick_interrupts_masked
        .type   ravenbrick_interrupts_masked, %function
ravenbrick_interrupts_masked:
        mrs     r0, cpsr
        mov     r0, r0, lsr #7
        and     r0, r0, #1
        bx      lr
        .size   ravenbrick_interrupts_masked, . - ravenbrick_interrupts_masked
