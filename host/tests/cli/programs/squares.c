/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/* Prints by the C library's semihosting and ends with a code. */
#include <stdio.h>

int total;

int add(int amount)
{
    total += amount;
    return total;
}

int main(void)
{
    for (int number = 1; number <= 3; number++) {
        printf("%d: %d so far\n", number, add(number * number));
    }
    fprintf(stderr, "sum %d\n", total);
    return 7;
}
