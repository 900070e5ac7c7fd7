/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
   SPDX-License-Identifier: Apache-2.0 */
/* An image with symbols and debug information, to be damaged. */

struct wheel {
    int counts[3];
    unsigned char port;
    float gain;
};

union word {
    unsigned bits;
    float value;
};

struct wheel wheels[2] = {{{1, 2, 3}, 'B', 0.5f}, {{4, 5, 6}, 'C', 2.0f}};
volatile union word shown;
static int total;

static int sum(const struct wheel *wheel)
{
    int all = 0;
    for (int i = 0; i < 3; i++)
        all += wheel->counts[i];
    return all;
}

void _start(void)
{
    for (;;) {
        total += sum(&wheels[total & 1]);
        shown.bits = (unsigned)total;
    }
}
