/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* The kernel's state, the environment task and the description of the threads for observers */

#include "layout.h"

        .section .bss.ravenbrick_kernel, "aw", %nobits
        .balign 8
        .global ravenbrick_kernel
        .global ravenbrick_running_thread
        .global ravenbrick_first_thread
        .type   ravenbrick_kernel, %object
        .type   ravenbrick_running_thread, %object
        .type   ravenbrick_first_thread, %object
ravenbrick_kernel:
ravenbrick_running_thread:
        .space  4
        .size   ravenbrick_running_thread, 4
        .space  8
ravenbrick_first_thread:
        .space  4
        .size   ravenbrick_first_thread, 4
        .space  KERNEL_SIZE - KERNEL_SENTINEL
        .size   ravenbrick_kernel, . - ravenbrick_kernel

/* The environment task: a thread and what a task's control block has behind it */
        .section .bss.ravenbrick_environment, "aw", %nobits
        .balign 8
        .global ravenbrick_environment
        .type   ravenbrick_environment, %object
ravenbrick_environment:
        .space  CONTROL_BLOCK_SIZE
        .size   ravenbrick_environment, CONTROL_BLOCK_SIZE

        .section .rodata.ravenbrick_thread_layout, "a"
        .balign 4
        .global ravenbrick_thread_layout
        .type   ravenbrick_thread_layout, %object
ravenbrick_thread_layout:
        .word   1                       /* version of this table */
        .word   CONTROL_BLOCK_SIZE
        .word   THREAD_NEXT_CREATED
        .word   THREAD_NAME
        .word   THREAD_NAME_LENGTH
        .word   THREAD_BASE_PRIORITY
        .word   THREAD_ACTIVE
        .word   THREAD_STATE
        .word   THREAD_WAKE
        .word   THREAD_STACK_BASE
        .word   THREAD_STACK_SIZE
        .size   ravenbrick_thread_layout, . - ravenbrick_thread_layout
