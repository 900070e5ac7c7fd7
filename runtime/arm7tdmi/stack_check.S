/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* Stack checking of units compiled with STACK_CHECK=yes (-fstack-check=generic): each subprogram
   that calls others or has more than a few words of local data calls _gnat_stack_check when it
   has taken its frame, and before it takes more for data whose size it computes. */

#include "layout.h"

/* What the compiler subtracts from the stack pointer, for probes that it does not make here */
#define COMPILER_REACH 4392

        .arm
        .section .text._gnat_stack_check, "ax"

/* r0: stack pointer - COMPILER_REACH - bytes to be taken. Below that must remain what is needed
   without a check: a preemption, the kernel, and subprograms that call none. */
        .global _gnat_stack_check
        .type   _gnat_stack_check, %function
_gnat_stack_check:
        mrs     r2, cpsr
        mov     r1, #KERNEL
        ldr     r1, [r1, #KERNEL_CURRENT]
        tst     r2, #(MODE_SYSTEM_BITS & ~MODE_SUPERVISOR_BITS)
        ldrne   r1, [r1, #THREAD_STACK_BASE]
        ldreq   r1, =ravenbrick_handler_stack
        add     r0, r0, #(COMPILER_REACH & 0xFF00)
        add     r0, r0, #(COMPILER_REACH & 0xFF)
        ldr     r2, =ravenbrick_stack_margin
        sub     r0, r0, r2
        cmp     r0, r1
        cmphs   sp, r0
        bxhs    lr
        sub     r1, r1, r0
        ldr     r0, =ravenbrick_stack_missing
        str     r1, [r0]
        ldr     r0, =overflow_text
        mov     r1, #0
        b       __gnat_last_chance_handler
        .size   _gnat_stack_check, . - _gnat_stack_check

        .section .rodata.stack_check, "a"
overflow_text:  .asciz  "Storage_Error: stack overflow"

/* Bytes by which a stack is too small, with the margin: more than there are when what was asked for
   lies outside of the memory. Zero until a check has failed. */
        .section .bss.ravenbrick_stack_missing, "aw", %nobits
        .balign 4
        .global ravenbrick_stack_missing
        .type   ravenbrick_stack_missing, %object
ravenbrick_stack_missing:
        .space  4
        .size   ravenbrick_stack_missing, 4
