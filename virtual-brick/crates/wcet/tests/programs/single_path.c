/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/* Functions with one path whatever their arguments: the bound must equal the time. */

static int table[16];
static const unsigned char weights[8] = {1, 2, 3, 5, 8, 13, 21, 34};

int add_up(int a, int b, int c)
{
  return a + 3 * b - (c >> 2);
}

int fill(void)
{
  for (int i = 0; i < 16; i++)
    table[i] = i + 7;
  return table[15];
}

int triangle(int x)
{
  int sum = x;
  for (int i = 0; i < 9; i++)
    for (int j = 0; j < 6; j++)
      sum += table[j] ^ i;
  return sum;
}

int weigh(const int *values)
{
  int sum = 0;
  for (int i = 0; i < 8; i++)
    sum += (table[i] >> 1) + weights[i];
  return sum;
}

static __attribute__((noinline)) int twice(int x)
{
  return x + x;
}

int chain(int x)
{
  int sum = 0;
  for (int i = 12; i > 0; i -= 3)
    sum += twice(x - i);
  return sum;
}

int shifts(unsigned x)
{
  int sum = 0;
  for (unsigned bit = 1; bit < 0x1000; bit <<= 2)
    sum += (x & bit) + 1;
  return sum;
}

int frame(int x)
{
  volatile int local[10];
  for (int i = 0; i < 10; i++)
    local[i] = x + i;
  return local[3];
}
