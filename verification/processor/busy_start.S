@ SPDX-FileCopyrightText: 2026 Ravenbrick contributors
@ SPDX-License-Identifier: Apache-2.0
@ Entry in ARM state: a stack, the program, the exit call.
        .arm
        .section .text.start, "ax"
        .global start
start:  ldr     sp, =stack_top
        ldr     r0, =run
        mov     lr, pc
        bx      r0
        mov     r0, #0
        mov     r7, #1
        .global finish
finish: swi     0
