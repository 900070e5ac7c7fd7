/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/* Loops whose bounds are given. */

static volatile int port;

__attribute__((noinline)) int grow(int wanted)
{
  int tries = 0;
  while (port < wanted)
    port = ++tries;
  return tries;
}

__attribute__((noinline)) int shrink(int wanted)
{
  int tries = 0;
  while (port > wanted)
    port = -++tries;
  return tries;
}

int both(int wanted)
{
  return grow(wanted) + shrink(0);
}

int nested(int rounds)
{
  int sum = 0;
  while (port < rounds) {
    port++;
    while (sum & 7)
      sum += port;
    sum += 3;
  }
  return sum;
}

static volatile unsigned length;
static volatile unsigned char store[64];

__attribute__((noinline)) void fill(unsigned count)
{
  for (unsigned at = 0; at < count; at++)
    store[at] = (unsigned char)at;
}

__attribute__((noinline)) void fill_all(void)
{
  fill(40);
}

__attribute__((noinline)) void fill_some(void)
{
  fill(length);
}

void either(void)
{
  if (port)
    fill_all();
  else
    fill_some();
}

int samples[8];

__attribute__((noreturn, noinline)) void failed(void)
{
    for (;;)
        ;
}

/* Left early only by a way that does not come back. */
int checked(const int *items, int last)
{
    int sum = 0, place = 0;
    do {
        if (items[place] < 0)
            failed();
        sum += items[place];
    } while (place++ != last);
    return sum;
}
