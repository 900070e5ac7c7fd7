/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* Charge the ticks of the clock since the last charge to r3: the current thread or handler. An
   account is 16 bits high at offset 58 of a thread and 32 bits low at 60; handlers have theirs in
   a table. r12 is 0; r0-r3 change. */

#define ACCOUNT_HIGH 58
#define ACCOUNT_LOW 60
#define IDLE_THREAD (KERNEL + KERNEL_IDLE)

/* Records of Ravenbrick.Interrupts: 33 of 16 bytes, of which a current handler is the second half.
   Half the distance is the place in the table of accounts of 8 bytes, plus 4. */
#define HANDLERS_SIZE (33 * 16)

#ifdef TIMED
        .macro  charge
        ldr     r0, [r12, #PIT_PIIR]
        ldr     r1, =ravenbrick_charged_at
        ldr     r2, [r1]
        str     r0, [r1]
        sub     r0, r0, r2
        ldr     r1, =ravenbrick__interrupts__handlers
        sub     r1, r3, r1
        cmp     r1, #HANDLERS_SIZE
        ldrlo   r2, =ravenbrick_handler_accounts - ACCOUNT_LOW
        addlo   r3, r2, r1, lsr #1
        cmp     r3, #IDLE_THREAD
        ldreq   r3, =ravenbrick_idle_account - ACCOUNT_LOW + 4
        ldr     r1, [r3, #ACCOUNT_LOW]
        adds    r1, r1, r0
        str     r1, [r3, #ACCOUNT_LOW]
        ldrcsh  r1, [r3, #ACCOUNT_HIGH]
        addcs   r1, r1, #1
        strcsh  r1, [r3, #ACCOUNT_HIGH]
        .endm
#endif
