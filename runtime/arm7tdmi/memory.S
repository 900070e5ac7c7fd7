/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* memcpy, memmove, memset and memcmp, which the compiler calls */

        .arm

        .section .text.memcpy, "ax"
        .global memcpy
        .type   memcpy, %function
memcpy: orr     r3, r0, r1
        tst     r3, #3
        mov     r12, r0
        bne     2f
1:      subs    r2, r2, #4
        ldrhs   r3, [r1], #4
        strhs   r3, [r12], #4
        bhi     1b
        bxeq    lr
        addlo   r2, r2, #4
2:      subs    r2, r2, #1
        ldrhsb  r3, [r1], #1
        strhsb  r3, [r12], #1
        bhi     2b
        bx      lr
        .size   memcpy, . - memcpy

        .section .text.memmove, "ax"
        .global memmove
        .type   memmove, %function
memmove:
        cmp     r0, r1
        bls     memcpy
1:      subs    r2, r2, #1
        ldrhsb  r3, [r1, r2]
        strhsb  r3, [r0, r2]
        bhi     1b
        bx      lr
        .size   memmove, . - memmove

        .section .text.memset, "ax"
        .global memset
        .type   memset, %function
memset: mov     r12, r0
        tst     r0, #3
        bne     2f
        and     r1, r1, #0xFF
        orr     r3, r1, r1, lsl #8
        orr     r3, r3, r3, lsl #16
1:      subs    r2, r2, #4
        strhs   r3, [r12], #4
        bhi     1b
        bxeq    lr
        addlo   r2, r2, #4
2:      subs    r2, r2, #1
        strhsb  r1, [r12], #1
        bhi     2b
        bx      lr
        .size   memset, . - memset

        .section .text.memcmp, "ax"
        .global memcmp
        .type   memcmp, %function
memcmp: mov     r12, r0
1:      subs    r2, r2, #1
        movlo   r0, #0
        bxlo    lr
        ldrb    r0, [r12], #1
        ldrb    r3, [r1], #1
        subs    r0, r0, r3
        beq     1b
        bx      lr
        .size   memcmp, . - memcmp
