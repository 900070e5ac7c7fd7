@ SPDX-FileCopyrightText: 2026 Ravenbrick contributors
@ SPDX-License-Identifier: Apache-2.0
@ Programs on which engines that decode or compile ahead can be slower than single steps. One is
@ chosen with -D; cliffs.py lists them.
        .include "start.inc"
body:

#if defined FLASH_MODE_SAME
        @ The flash mode register is written with the value it has.
        ldr     r2, =MC_FMR
        ldr     r1, =0x00340100
1:      str     r1, [r2]
        work    1
        work    2
        b       1b

#elif defined FLASH_MODE_CHANGES
        @ The flash gets another number of wait states in each turn.
        ldr     r2, =MC_FMR
        ldr     r1, =0x00340100
1:      eor     r1, r1, #0x300
        str     r1, [r2]
        work    1
        work    2
        b       1b

#elif defined REMAP
        @ The memory map changes in each turn.
        ldr     r2, =MC_RCR
        mov     r1, #1
1:      str     r1, [r2]
        work    1
        work    2
        b       1b

#elif defined BRANCHY_FLASH
        @ 240 KB of short blocks, again and again.
1:      many_blocks 7400, 1
        b       far
        .ltorg
far:    b       1b

#elif defined BRANCHY_RAM
        @ 37 KB of short blocks, again and again.
1:      many_blocks 1150, 1
        b       1b

#elif defined BRANCHY_SOMETIMES
        @ 32 functions at a time of 1000, each some hundred times.
        mov     r6, #0
1:      mov     r7, #250
2:      and     r9, r7, #31
        add     r9, r9, r6
        mov     r8, #28
        mul     r3, r9, r8
        ldr     r2, =functions
        add     r2, r2, r3
        mov     lr, pc
        bx      r2
        subs    r7, r7, #1
        bne     2b
        add     r6, r6, #32
        cmp     r6, #960
        movge   r6, #0
        b       1b
        .ltorg
functions:
        .set    number, 0
        .rept   1000
        work    number
        tst     r5, #(1 << (number % 8))
        addeq   r4, r4, #1
        subne   r5, r5, #1
        eor     r4, r4, r5
        bx      lr
        .set    number, number + 1
        .endr

#elif defined PATCH_ONE
        @ One instruction gets another constant in each turn.
        ldr     r2, =patched
        ldr     r1, =0xE2844001
1:      eor     r1, r1, #6
        str     r1, [r2]
        work    1
        work    2
        mov     r7, #4
2:      work    3
patched: add    r4, r4, #1
        subs    r7, r7, #1
        bne     2b
        b       1b

#elif defined PATCH_RARE || defined PATCH_COMPILED
        @ An instruction in a busy loop is patched every 1000 turns, or when the loop has just been
        @ compiled.
#ifdef PATCH_RARE
        .set    TURNS, 1000
#else
        .set    TURNS, 16000
#endif
        ldr     r2, =rare
        ldr     r1, =0xE2844001
1:      eor     r1, r1, #6
        str     r1, [r2]
        ldr     r7, =TURNS
2:      work    3
        work    4
rare:   add     r4, r4, #1
        subs    r7, r7, #1
        bne     2b
        b       1b

#elif defined OVERLAY
        @ Two functions are copied to one place in turns, as overlays are, and called a few times.
1:      ldr     r0, =overlay_a
        bl      load_and_call
        ldr     r0, =overlay_b
        bl      load_and_call
        b       1b
load_and_call:
        mov     r9, lr
        ldr     r1, =DATA + 0x400
        ldmia   r0, {r2, r3, r6, r7, r8, r11}
        stmia   r1, {r2, r3, r6, r7, r8, r11}
        mov     r6, #8
2:      mov     lr, pc
        bx      r1
        subs    r6, r6, #1
        bne     2b
        bx      r9
overlay_a: work 1
        work    2
        mov     r7, #1
        bx      lr
overlay_b: work 3
        work    4
        mov     r7, #2
        bx      lr

#elif defined DATA_BESIDE_CODE
        @ A counter right behind the instruction that stores it last.
        ldr     r2, =beside
1:      work    1
        work    2
        ldr     r1, [r2]
        add     r1, r1, #1
        str     r1, [r2]
        b       1b
beside: .word   0

#elif defined BIT_BANG
        @ A port as serial line: set, clear.
        ldr     r2, =PIO
        mov     r1, #1 << 4
        str     r1, [r2]
        str     r1, [r2, #0x10]
1:      str     r1, [r2, #0x30]
        nop
        str     r1, [r2, #0x34]
        add     r4, r4, #1
        b       1b

#elif defined PORT_POLLING
        @ A port is read until a level that never comes.
        ldr     r2, =PIO
1:      ldr     r1, [r2, #0x3C]
        add     r4, r4, #1
        tst     r1, #1 << 30
        tsteq   r1, #1 << 29
        beq     1b
        b       1b

#elif defined ADC_POLLING
        @ Conversions, one after the other.
        ldr     r2, =ADC
        ldr     r1, =0x00000700
        str     r1, [r2, #4]
        mov     r1, #1 << 4
        str     r1, [r2, #0x10]
        mov     r3, #2
1:      str     r3, [r2]
2:      ldr     r1, [r2, #0x1C]
        tst     r1, #1 << 4
        beq     2b
        ldr     r1, [r2, #0x40]
        add     r4, r4, r1
        b       1b

#elif defined TIMER_POLLING || defined FAST_WAVE
        @ A channel of the timer counter counts; its value is read until it is large.
        poke    PMC + 0x10, 1 << 12
        ldr     r2, =TC0
#if defined FAST_WAVE
        ldr     r1, =0x0009C000
        str     r1, [r2, #4]
        mov     r1, #1
        str     r1, [r2, #0x1C]
#else
        mov     r1, #0
        str     r1, [r2, #4]
#endif
        mov     r1, #5
        str     r1, [r2]
#if defined FAST_WAVE
1:      work    1
        work    2
        work    3
        b       1b
#else
1:      ldr     r3, [r2, #0x10]
2:      ldr     r1, [r2, #0x10]
        sub     r1, r1, r3
        mov     r1, r1, lsl #16
        cmp     r1, #100 << 16
        blo     2b
        add     r4, r4, #1
        b       1b
#endif

#elif defined PIT_POLLING
        @ The image of the interval timer is read until a millisecond has passed.
        poke    PIT, 0x010FFFFF
        ldr     r2, =PIT
1:      ldr     r3, [r2, #12]
2:      ldr     r1, [r2, #12]
        sub     r1, r1, r3
        cmp     r1, #3008
        blo     2b
        add     r4, r4, #1
        b       1b

#elif defined PIT_FAST
        @ The interval timer elapses every 16 cycles; nobody asks.
        poke    PIT, 0x01000000
1:      work    1
        work    2
        work    3
        b       1b

#elif defined PIT_32
        @ The interval timer elapses every 32 cycles; nobody asks.
        poke    PIT, 0x01000001
1:      work    1
        work    2
        work    3
        work    4
        ldr     r1, [r10]
        add     r1, r1, #1
        str     r1, [r10]
        b       1b

#elif defined INTERRUPT_200 || defined INTERRUPT_2000
        @ An interrupt every 200 or 2000 cycles.
        vectors_in_ram
        poke    AIC + 4, 0
        poke    AIC + 0x120, 2
#if defined INTERRUPT_200
        poke    PIT, 0x0300000C
#else
        poke    PIT, 0x0300007C
#endif
        msr     cpsr_c, #0x13
1:      work    1
        work    2
        work    3
        work    4
        b       1b

#elif defined SOFTWARE_INTERRUPT
        @ A system call in each turn.
        vectors_in_ram
        msr     cpsr_c, #0x10
        ldr     sp, =STACK - 0xA00
1:      swi     0
        work    1
        work    2
        work    3
        b       1b

#elif defined UNDEFINED
        @ An undefined instruction in each turn.
        vectors_in_ram
1:      .word   0xE7FFFFFF
        work    1
        work    2
        work    3
        b       1b

#elif defined ABORTS
        @ A misaligned load in each turn.
        vectors_in_ram
        add     r2, r10, #1
1:      ldr     r1, [r2]
        work    1
        work    2
        work    3
        b       1b

#elif defined SWAP
        @ A lock with SWP in each turn.
        mov     r1, #1
1:      swp     r3, r1, [r10]
        work    1
        work    2
        str     r4, [r10]
        b       1b

#elif defined MASKING
        @ Short critical sections.
1:      mrs     r3, cpsr
        orr     r1, r3, #0x80
        msr     cpsr_c, r1
        ldr     r2, [r10]
        add     r2, r2, #1
        str     r2, [r10]
        msr     cpsr_c, r3
        work    1
        b       1b

#elif defined LARGE_FRAMES
        @ Calls that take 160 bytes of the stack each.
1:      bl      large
        bl      large
        b       1b
large:  stmdb   sp!, {r4, lr}
        sub     sp, sp, #160
        str     r5, [sp, #8]
        work    1
        ldr     r5, [sp, #8]
        add     sp, sp, #160
        ldmia   sp!, {r4, lr}
        bx      lr

#elif defined RECURSION
        @ A function calls itself 40 times.
1:      mov     r0, #40
        bl      recursive
        b       1b
recursive:
        stmdb   sp!, {r0, r4, lr}
        subs    r0, r0, #1
        work    1
        blne    recursive
        ldmia   sp!, {r0, r4, pc}

#elif defined JUMP_TABLE
        @ Indirect jumps to 256 places in an order that looks random.
        ldr     r2, =1103515245
        ldr     r3, =12345
        b       1f
        .ltorg
1:      mla     r6, r2, r6, r3
        mov     r1, r6, lsr #24
        add     r0, pc, #4
        add     r0, r0, r1, lsl #4
        bx      r0
        .set    number, 0
        .rept   256
        work    number
        add     r6, r6, #1
        b       1b
        .set    number, number + 1
        .endr

#elif defined FLASH_TABLES
        @ Tables in flash, read word by word.
        ldr     r2, =start
1:      mov     r7, #0
2:      ldr     r1, [r2, r7]
        add     r4, r4, r1
        ldrb    r1, [r2, r4, lsr #20]
        add     r5, r5, r1
        add     r7, r7, #4
        cmp     r7, #1024
        blo     2b
        b       1b

#elif defined MIRRORED
        @ Data at another address of the RAM.
        add     r2, r10, #0x10000
1:      ldr     r1, [r2]
        add     r1, r1, #1
        str     r1, [r2]
        work    1
        work    2
        b       1b

#elif defined RAM_AT_ZERO
        @ Data at address 0 behind the vectors.
        vectors_in_ram
        mov     r2, #0x400
1:      ldr     r1, [r2]
        add     r1, r1, #1
        str     r1, [r2]
        work    1
        work    2
        b       1b

#elif defined INTERWORKING
        @ A change of state in each turn.
1:      ldr     r0, =in_thumb + 1
        mov     lr, pc
        bx      r0
        work    1
        b       1b
        .ltorg
        .thumb
in_thumb: adds  r4, r4, #1
        lsls    r5, r4, #2
        bx      lr
        .arm

#elif defined SLEEP
        @ The processor sleeps until an interrupt every 10,000 cycles.
        vectors_in_ram
        poke    AIC + 4, 0
        poke    AIC + 0x120, 2
        poke    PIT, 0x03000270
        msr     cpsr_c, #0x13
        ldr     r2, =PMC
        mov     r1, #1
1:      str     r1, [r2, #4]
        work    1
        b       1b

#elif defined STRAIGHT_ON
        @ 200 KB of code without a loop, passed a few times, then a spin.
        mov     r7, #60
1:      many_blocks 2000, 10
        subs    r7, r7, #1
        bne     far
        b       .
        .ltorg
far:    b       1b

#elif defined SHORT_RUN
        @ 600 blocks that run 250 times each, then a spin.
        mov     r7, #250
1:      many_blocks 150, 4
        subs    r7, r7, #1
        bne     1b
        b       .

#elif defined BUSY
        @ The case that JIT code is for.
1:      mov     r7, #100
2:      ldr     r1, [r10, r7, lsl #2]
        add     r1, r1, r7
        str     r1, [r10, r7, lsl #2]
        work    1
        subs    r7, r7, #1
        bne     2b
        b       1b
#else
        .error  "no program was chosen"
#endif
        .ltorg
