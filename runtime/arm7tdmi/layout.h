/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* Processor modes and flags, and offsets of the records that Ada and assembly share */

#define MODE_MASK 0x1F
#define MODE_SYSTEM_BITS 0x1F
#define MODE_SUPERVISOR_BITS 0x13

/* The fast interrupt is the watchdog's: never masked before the program has failed */
#define MODE_FIQ 0x11
#define MODE_IRQ 0x12
#define MODE_SUPERVISOR 0x13
#define MODE_SYSTEM 0x1F
#define IRQ_MASKED 0x80
#define ALL_MASKED 0xC0

/* Ravenbrick.Threads.Thread */
#define THREAD_ACTIVE 0
#define THREAD_STACK_POINTER 8
#define THREAD_NEXT 12
#define THREAD_BASE_PRIORITY 20
#define THREAD_STATE 24
#define THREAD_NAME 28
#define THREAD_NAME_LENGTH 32
#define THREAD_NEXT_CREATED 36
#define THREAD_WAKE 40
#define THREAD_STACK_BASE 48
#define THREAD_STACK_SIZE 52
#define CONTROL_BLOCK_SIZE 64

/* Ravenbrick.Threads.Kernel_State and where the RAM shown at address 0 has it */
#define KERNEL 0x200
#define KERNEL_RUNNING 0
#define KERNEL_CURRENT 4
#define KERNEL_READY_HEAD 8
#define KERNEL_FIRST_CREATED 12
#define KERNEL_SENTINEL 16
#define KERNEL_IDLE 72
#define KERNEL_SIZE 128

/* Registers of the chip, relative to address 0 modulo 2**32 */
#define AIC_IVR (-0xF00)
#define AIC_EOICR (-0xED0)
#define PMC_SCDR (-0x3FC)
#define PIT_PIIR (-0x2C4)
