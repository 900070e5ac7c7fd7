/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* The end of a program that failed: the application's hook, if any, is told the place, then
   a second one, if any, has the processor for good; without it the processor halts. Interrupts
   stay masked, the fast one too. Processor exceptions and the watchdog end here. */

#include "layout.h"

/* In ravenbrick_failure */
#define REPORTED 16

        .arm
        .section .text.failure, "ax"

        .global ravenbrick_undefined_instruction, ravenbrick_software_interrupt
        .global ravenbrick_prefetch_abort, ravenbrick_data_abort
ravenbrick_undefined_instruction:
        sub     r1, lr, #4
        ldr     r0, =undefined_text
        b       __gnat_last_chance_handler
ravenbrick_software_interrupt:
        sub     r1, lr, #4
        ldr     r0, =software_text
        b       __gnat_last_chance_handler
ravenbrick_prefetch_abort:
        sub     r1, lr, #4
        ldr     r0, =prefetch_text
        b       __gnat_last_chance_handler
ravenbrick_data_abort:
        mrs     r0, spsr
        and     r0, r0, #MODE_MASK
        cmp     r0, #MODE_FIQ
        beq     watchdog_expired
        sub     r1, lr, #8
        ldr     r0, =data_text
        b       __gnat_last_chance_handler

/* The fast interrupt, see interrupt.S. Its link register is 4 above the interrupted instruction. */
watchdog_expired:
        msr     cpsr_c, #(MODE_FIQ | ALL_MASKED)
        sub     r1, lr, #4
        ldr     r0, =watchdog_text
        b       __gnat_last_chance_handler

/* r0: address of a file name or a message that ends with NUL; r1: line, or code address of a
   processor exception. The handlers' stack is free to use: nothing returns. */
        .global __gnat_last_chance_handler
        .type   __gnat_last_chance_handler, %function
__gnat_last_chance_handler:
        msr     cpsr_c, #(MODE_SUPERVISOR | ALL_MASKED)
        ldr     sp, =ravenbrick_handler_stack_top
        mov     r3, #KERNEL
        ldr     r3, [r3, #KERNEL_CURRENT]
        ldr     r2, =ravenbrick_failure
        stmia   r2, {r0, r1, r3}
        .weak   ravenbrick_last_chance_hook
        ldr     r2, =ravenbrick_last_chance_hook
        cmp     r2, #0
        movne   lr, pc
        bxne    r2
        ldr     r2, =ravenbrick_failure
        mov     r1, #1
        str     r1, [r2, #REPORTED]
        .weak   ravenbrick_failed_program_hook
        ldr     r2, =ravenbrick_failed_program_hook
        cmp     r2, #0
        movne   lr, pc
        bxne    r2
        .global ravenbrick_halt
ravenbrick_halt:
        b       ravenbrick_halt
        .size   __gnat_last_chance_handler, . - __gnat_last_chance_handler

        .section .rodata.failure, "a"
undefined_text: .asciz  "undefined instruction"
software_text:  .asciz  "software interrupt"
prefetch_text:  .asciz  "prefetch abort"
data_text:      .asciz  "data abort"
watchdog_text:  .asciz  "watchdog expired"

/* Where the program failed: text, line, the current thread or handler, the protected object of a
   ceiling violation, and 1 as soon as the hook was told. The text is zero while the program has not
   failed, the object in all other failures. */
        .section .bss.ravenbrick_failure, "aw", %nobits
        .balign 4
        .global ravenbrick_failure
        .type   ravenbrick_failure, %object
ravenbrick_failure:
        .space  20
        .size   ravenbrick_failure, 20
