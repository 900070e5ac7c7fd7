/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/* Functions whose time depends on their arguments: the bound must never be below it. */

static int sink[32];

static __attribute__((noinline)) int slow(int x)
{
  int sum = 0;
  for (int i = 0; i < 5; i++)
    sum += x * i;
  return sum;
}

static __attribute__((noinline)) int quick(int x)
{
  return x - 1;
}

int choose(int selector, int x)
{
  switch (selector) {
  case 0: return slow(x);
  case 1: return quick(x) + 3;
  case 2: sink[2] = x; return slow(quick(x));
  case 3: return x * x * 5;
  case 4: sink[4] ^= x; break;
  case 5: return slow(x) - slow(x + 1);
  case 6: return quick(x ^ 5);
  case 7: sink[0] = quick(x); break;
  case 8: return 77 - x;
  case 9: x += sink[1] * 3;
  case 10: x ^= 21;
  default: break;
  }
  return x + 1;
}

int search(int wanted)
{
  for (int i = 0; i < 32; i++)
    if (sink[i] == wanted)
      return i;
  return -1;
}

int saturate(int x, int low, int high)
{
  if (x < low)
    x = low;
  else if (x > high)
    x = high;
  return x < 0 ? -x : x;
}

int clipped(unsigned count)
{
  int sum = 0;
  if (count > 20)
    count = 20;
  for (unsigned i = 0; i < count; i++)
    sum += sink[i & 31];
  return sum;
}

int order(void)
{
  int moved = 0;
  for (int i = 0; i < 31; i++)
    for (int j = 0; j < 31 - i; j++)
      if (sink[j] > sink[j + 1]) {
        int held = sink[j];
        sink[j] = sink[j + 1];
        sink[j + 1] = held;
        moved++;
      }
  return moved;
}

int disorder(unsigned seed)
{
  for (int i = 0; i < 32; i++) {
    seed = seed * 1664525u + 1013904223u;
    sink[i] = (int)seed;
  }
  return sink[31];
}

int product(int a, int b)
{
  long long wide = (long long)a * b;
  return (int)(wide >> 16);
}

int tail(int x)
{
  if (x & 1)
    return slow(x);
  return quick(x);
}
