/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
 * SPDX-License-Identifier: Apache-2.0
 *
 * Functions that call `device_request` somewhere, each with what it still executes from there on.
 */

#define FUNCTION __attribute__((noinline))

volatile int places[8];

FUNCTION void device_request(int place)
{
    places[place & 7] = place;
}

FUNCTION int works(int times)
{
    int sum = 0;
    for (int count = 0; count < times; count++)
        sum += places[count & 7];
    return sum;
}

FUNCTION int late(void)
{
    int sum = works(60);
    device_request(1);
    return sum + works(7);
}

FUNCTION int late_rest(void)
{
    device_request(1);
    return works(7);
}

FUNCTION int inside(void)
{
    int sum = works(40);
    sum += late();
    return sum + works(9);
}

FUNCTION int inside_rest(void)
{
    return late_rest() + works(9);
}

FUNCTION int again(void)
{
    int sum = 0;
    for (int count = 0; count < 3; count++) {
        sum += works(20);
        device_request(count);
    }
    return sum;
}

FUNCTION int again_rest(void)
{
    device_request(0);
    int sum = works(20);
    device_request(1);
    sum += works(20);
    device_request(2);
    return sum;
}

FUNCTION int nowhere(void)
{
    return works(3);
}

int main(void)
{
    return inside() + inside_rest() + again() + again_rest() + nowhere();
}
