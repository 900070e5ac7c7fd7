/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* What the linker's command line says of the supervision: 0 where it says nothing */

        .altmacro
        .macro  deadline priority
        .weak   ravenbrick_deadline_\priority
        .word   ravenbrick_deadline_\priority
        .endm

        .section .rodata.ravenbrick_deadlines, "a"
        .balign 4
        .global ravenbrick_deadlines
        .type   ravenbrick_deadlines, %object
ravenbrick_deadlines:
        .set    next, 0
        .rept   39                      /* System.Any_Priority */
        deadline %next
        .set    next, next + 1
        .endr
        .size   ravenbrick_deadlines, . - ravenbrick_deadlines

        .global ravenbrick_supervision
        .type   ravenbrick_supervision, %object
        .weak   ravenbrick_supervised
ravenbrick_supervision:
        .word   ravenbrick_supervised
        .size   ravenbrick_supervision, 4

        .global ravenbrick_command_timeout
        .type   ravenbrick_command_timeout, %object
        .weak   ravenbrick_command_timeout_ms
ravenbrick_command_timeout:
        .word   ravenbrick_command_timeout_ms
        .size   ravenbrick_command_timeout, 4
