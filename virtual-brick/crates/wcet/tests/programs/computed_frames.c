// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0

/* Frames with an object whose size is computed, as Ada's strings of unknown length are. */

struct bounds {
        int first, last;
};

__attribute__((noipa)) static void touch(char *at)
{
        *at = 1;
}

__attribute__((noipa)) static unsigned length_of(const struct bounds *of)
{
        return of->last - of->first + 1;
}

/* No value stays in a register of these; r7 is the frame's pointer in Thumb state. */
#ifdef __thumb__
#define REGISTERS_USED __asm__ volatile("" ::: "r4", "r5", "r6", "r8", "r9", "r10", "r11")
#else
#define REGISTERS_USED __asm__ volatile("" ::: "r4", "r5", "r6", "r7", "r8", "r9", "r10")
#endif

/* In each turn the object is given back: the stack pointer is saved in the frame, whose address
   the callee gets. */
unsigned chosen(unsigned which)
{
        unsigned sum = 0;
        for (int turn = 0; turn < 3; turn++) {
                struct bounds text_bounds = {1, which & 1 ? 40 : 7};
                char text[length_of(&text_bounds)];
                touch(text);
                REGISTERS_USED;
                sum += text[0] + length_of(&text_bounds);
                which >>= 1;
        }
        return sum;
}

__attribute__((noipa)) unsigned copied(const struct bounds *of)
{
        char text[of->last - of->first + 1];
        touch(text);
        return text[0];
}

/* How long it is, only the frame of the caller shows. */
unsigned in_context(void)
{
        struct bounds text_bounds = {1, 40};
        unsigned longer = copied(&text_bounds);
        text_bounds.last = 20;
        return longer + copied(&text_bounds);
}

__attribute__((noipa)) unsigned any_length(unsigned length)
{
        char text[length];
        touch(text);
        return text[0];
}

unsigned perhaps_any_length(unsigned length, int wanted)
{
        return wanted ? any_length(length) : length;
}
