/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
 * SPDX-License-Identifier: Apache-2.0
 *
 * Ordinary forms of loops whose counts follow from the code, whatever the arguments are.
 */

volatile int sink;
volatile unsigned source[64];
static const unsigned char lengths[4] = { 3, 9, 5, 7 };
static const char text[] = "ravenbrick";
struct frame { unsigned char size; int words[16]; } frame;

#define FORM(name) void form_##name(unsigned n, int s, unsigned m, int t)
#define BODY sink += 3

FORM(mask)
{
    for (unsigned i = n & 15; i > 0; i--) BODY;
}

FORM(masked_end)
{
    for (unsigned i = 0; i < (n & 31); i++) BODY;
}

FORM(modulo)
{
    for (unsigned i = 0; i < n % 10; i++) BODY;
}

FORM(signed_modulo)
{
    for (int i = 0; i < s % 7; i++) BODY;
}

FORM(division)
{
    do { sink = n % 10; n /= 10; } while (n);
}

FORM(divided_count)
{
    for (unsigned i = 0; i < n / 0x8000000; i++) BODY;
}

FORM(signed_division)
{
    while (s) { BODY; s /= 10; }
}

FORM(halving)
{
    while (s) { BODY; s /= 2; }
}

FORM(shift_right)
{
    while (n) { BODY; n >>= 1; }
}

FORM(shift_by_four)
{
    while (n) { BODY; n >>= 4; }
}

FORM(shift_left)
{
    while (n) { BODY; n <<= 1; }
}

FORM(power_of_two)
{
    for (unsigned bit = 1; bit; bit <<= 1) if (n & bit) BODY;
}

FORM(population_count)
{
    while (n) { BODY; n &= n - 1; }
}

FORM(lowest_bit)
{
    n |= 0x8000; while (!(n & 1)) { BODY; n >>= 1; }
}

FORM(signed_char)
{
    for (signed char i = 0; i < (signed char)s; i++) BODY;
}

FORM(unsigned_char)
{
    for (unsigned char i = n; i; i--) BODY;
}

FORM(short_to_zero)
{
    for (short i = s; i < 0; i++) BODY;
}

FORM(product)
{
    for (unsigned i = 0; i < (n & 7) * (m & 3); i++) BODY;
}

FORM(nested_product)
{
    for (unsigned i = 0; i < (n & 7); i++) for (unsigned j = 0; j < i * 2; j++) BODY;
}

FORM(pointer_to_end)
{
    volatile unsigned *p = source, *end = source + (n & 31); while (p != end) *p++ = 1;
}

FORM(argument_to_end)
{
    volatile unsigned *p = (unsigned *)n, *end = p + (m & 15); while (p != end) (void)*p++;
}

FORM(clamped)
{
    if (n > 20) n = 20; while (n--) BODY;
}

FORM(signed_clamp)
{
    if (s > 20) s = 20; for (int i = 0; i < s; i++) BODY;
}

FORM(both_clamps)
{
    if (s < -5) s = -5; if (s > 9) s = 9; for (int i = -5; i < s; i++) BODY;
}

FORM(stride)
{
    for (unsigned i = 0; i < (n & 63); i += 4) BODY;
}

FORM(down_by_three)
{
    for (int i = 60; i > (s & 7); i -= 3) BODY;
}

FORM(meeting)
{
    for (int i = 0, j = n & 31; i < j; i++, j--) BODY;
}

FORM(triangle)
{
    for (int i = 0; i < 9; i++) for (int j = i; j < 9; j++) BODY;
}

FORM(early_exit)
{
    for (int i = 0; i < 16 && source[i] != n; i++) BODY;
}

FORM(table)
{
    for (int i = 0; i < lengths[n & 3]; i++) BODY;
}

FORM(string)
{
    for (const char *p = text; *p; p++) sink = *p;
}

FORM(field)
{
    for (int i = 0; i < frame.size; i++) sink = frame.words[i & 15];
}

