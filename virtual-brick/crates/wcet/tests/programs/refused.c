/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/* Functions that have no bound until the user says more, or at all. */

static volatile int port;

__attribute__((noinline)) int descend(int n)
{
  if (n <= 0)
    return 1;
  return n * descend(n - 1) + port;
}

int outer(int n)
{
  return descend(n) + 1;
}

int poll(int wanted)
{
  int tries = 0;
  while (port != wanted)
    tries++;
  return tries;
}

int through(int (*step)(int), int x)
{
  return step(x) + 1;
}

__attribute__((noinline)) int first(int x)
{
  return x + port;
}

__attribute__((noinline)) int second(int x)
{
  return x * x + port + port;
}

/* Words after a table of functions, as the linker's unwind index has them. */
static const unsigned table[4] = {(unsigned)first, (unsigned)second, 0x7fffff38, 0x7fffff44};

int from_table(unsigned which, int x)
{
  return ((int (*)(int))table[which & 3])(x) + 1;
}

void forever(void)
{
  for (;;)
    port++;
}

int two_entries(int x)
{
  if (x & 1)
    goto middle;
  do {
    port += 1;
middle:
    port += x;
  } while (port < 100);
  return port;
}

int trap(int x)
{
  __asm__ volatile("swi 1");
  return x;
}
