/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* Exception vectors with the interrupt entry and exit right behind them. The vector of the fast
   interrupt falls on the entry's second instruction. Only the watchdog requests it, to end the
   program. The stack pointer of FIQ mode points to where there is no memory, so that this
   instruction becomes a data abort, which failure.S takes for the watchdog. A branch in its place
   would cost each interrupt 3 cycles. The start-up copies all of it to the beginning of
   the RAM, where it runs at address 0; only the first vector, the entry point of the image, is
   also used in place. Nothing here may refer to other code relative to itself.

   Handlers run in Supervisor mode on the handlers' stack with interrupts of higher levels
   unmasked; the interrupted registers wait on the stack of IRQ mode, one frame per nesting level.
   The exit of the outermost handler preempts the interrupted thread when a more urgent one
   has become ready. */

#include "layout.h"
#include "charge.h"

#define FRAME_SIZE 24

        .arm
        .section .vectors, "ax"
        .global _start, ravenbrick_vectors
_start:
ravenbrick_vectors:
        ldr     pc, =ravenbrick_reset
        ldr     pc, =ravenbrick_undefined_instruction
        ldr     pc, =ravenbrick_software_interrupt
        ldr     pc, =ravenbrick_prefetch_abort
        ldr     pc, =ravenbrick_data_abort
        nop

        .global ravenbrick_interrupt
        .type   ravenbrick_interrupt, %function
ravenbrick_interrupt:
        sub     lr, lr, #4
        stmfd   sp!, {r0-r3, r12, lr}
        mov     r12, #0
#ifdef TIMED
        ldr     r3, [r12, #(KERNEL + KERNEL_CURRENT)]
        charge
#endif
        ldr     r1, [r12, #AIC_IVR]     /* the source's handler, as a thread */
        str     r1, [r12, #AIC_IVR]     /* protect mode: this takes the interrupt */
        mrs     r2, spsr
        ldr     r3, [r12, #(KERNEL + KERNEL_CURRENT)]
        str     r1, [r12, #(KERNEL + KERNEL_CURRENT)]
        stmfd   sp!, {r2, r3}
        ldmdb   r1, {r0, r1}            /* object, code */
        msr     cpsr_c, #MODE_SUPERVISOR
        str     lr, [sp, #-4]!
        mov     lr, pc
        bx      r1
        ldr     lr, [sp], #4

        msr     cpsr_c, #(MODE_IRQ | IRQ_MASKED)
#ifdef TIMED
        mov     r12, #0
        ldr     r3, [r12, #(KERNEL + KERNEL_CURRENT)]
        charge
#endif
        mov     r1, #0
        str     r1, [r1, #AIC_EOICR]
        ldmfd   sp!, {r2, r3}
        str     r3, [r1, #(KERNEL + KERNEL_CURRENT)]
        and     r0, r2, #MODE_MASK
        cmp     r0, #MODE_SYSTEM_BITS
        bne     1f                      /* a handler was interrupted */
        ldr     r0, [r1, #(KERNEL + KERNEL_READY_HEAD)]
        ldr     r12, [r3, #THREAD_ACTIVE]
        ldr     lr, [r0, #THREAD_ACTIVE]
        cmp     lr, r12
        bgt     preempt
1:      msr     spsr_cxsf, r2
        ldmfd   sp!, {r0-r3, r12, pc}^

/* Store r2 or r3, the new head of the ready queue, and go on with the thread in r0 */
        .macro  go_on head
        mov     r1, #KERNEL
        str     \head, [r1, #KERNEL_READY_HEAD]
        str     r0, [r1, #KERNEL_RUNNING]
        str     r0, [r1, #KERNEL_CURRENT]
        ldr     sp, [r0, #THREAD_STACK_POINTER]
        ldr     pc, [sp], #4
        .endm

/* r0: the thread to run; r2: interrupted status; r3: the interrupted thread; r12: its urgency;
   the interrupted r0-r3, r12 and pc on the stack of IRQ mode */
preempt:
        cmn     r12, #1
        add     sp, sp, #FRAME_SIZE
        msr     cpsr_c, #(MODE_SYSTEM | IRQ_MASKED)
        beq     3f                      /* the idle loop has no context */
        stmfd   sp!, {r4-r11, lr}
        ldr     lr, =ravenbrick_interrupt_stack_top - FRAME_SIZE
        ldmia   lr, {r4-r9}
        ldr     r1, =resume
        stmfd   sp!, {r1, r2, r4-r9}
        str     sp, [r3, #THREAD_STACK_POINTER]

        /* the interrupted thread goes before its equals (RM D.2.3 (10)): in general to the head */
        ldr     r2, [r0, #THREAD_NEXT]
        ldr     r6, [r2, #THREAD_ACTIVE]
        cmp     r6, r12
        bgt     2f
take:   str     r2, [r3, #THREAD_NEXT]
        go_on   r3

2:      mov     r4, r2
        ldr     r2, [r4, #THREAD_NEXT]
        ldr     r6, [r2, #THREAD_ACTIVE]
        cmp     r6, r12
        bgt     2b
        str     r3, [r4, #THREAD_NEXT]
        str     r2, [r3, #THREAD_NEXT]

3:      ldr     r2, [r0, #THREAD_NEXT]
        go_on   r2

        .ltorg
        .global ravenbrick_vectors_end
ravenbrick_vectors_end:
        .size   ravenbrick_interrupt, . - ravenbrick_interrupt

/* Where a preempted thread goes on: on its stack status, r0-r3, r12, pc; r4-r11, lr */
        .section .text.ravenbrick_resume, "ax"
        .type   resume, %function
resume: mov     r0, sp
        add     sp, sp, #28
        ldmfd   sp!, {r4-r11, lr}
        msr     cpsr_c, #(MODE_IRQ | IRQ_MASKED)
        ldr     r1, [r0], #4
        msr     spsr_cxsf, r1
        ldr     lr, [r0, #20]
        ldmia   r0, {r0-r3, r12}
        movs    pc, lr
        .size   resume, . - resume
