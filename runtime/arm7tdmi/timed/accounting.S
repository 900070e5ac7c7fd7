/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* Execution-time accounts, in programs linked with EXECUTION_TIME=yes */

#include "layout.h"
#include "charge.h"

        .arm
        .section .text.ravenbrick_charge_execution_time, "ax"

/* Interrupts are masked */
        .global ravenbrick_charge_execution_time
        .type   ravenbrick_charge_execution_time, %function
ravenbrick_charge_execution_time:
        mov     r12, #0
        ldr     r3, [r12, #(KERNEL + KERNEL_CURRENT)]
        charge
        bx      lr
        .ltorg
        .size   ravenbrick_charge_execution_time, . - ravenbrick_charge_execution_time

        .section .bss.ravenbrick_accounts, "aw", %nobits
        .balign 8
        .global ravenbrick_charged_at, ravenbrick_handler_accounts, ravenbrick_idle_account
        .type   ravenbrick_charged_at, %object
        .type   ravenbrick_handler_accounts, %object
        .type   ravenbrick_idle_account, %object
ravenbrick_handler_accounts:
        .space  33 * 8
        .size   ravenbrick_handler_accounts, 33 * 8
ravenbrick_idle_account:
        .space  8
        .size   ravenbrick_idle_account, 8
ravenbrick_charged_at:
        .space  4
        .size   ravenbrick_charged_at, 4
