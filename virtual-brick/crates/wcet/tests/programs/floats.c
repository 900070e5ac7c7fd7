/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/* The compiler's support library for floats and division. */

float float_add(float a, float b) { return a + b; }
float float_multiply(float a, float b) { return a * b; }
float float_divide(float a, float b) { return a / b; }
int float_compare(float a, float b) { return a < b; }
int float_to_integer(float a) { return (int)a; }
float integer_to_float(int a) { return (float)a; }
unsigned unsigned_divide(unsigned a, unsigned b) { return a / b; }
int signed_divide(int a, int b) { return a / b; }
unsigned unsigned_rest(unsigned a, unsigned b) { return a % b; }

float float_sum(float a, float b)
{
  float sum = 0.0f;
  for (float x = 0.0f; x != b; x += 1.0f) {
    if (x >= 9.0f)
      break;
    sum += x * a;
  }
  return sum;
}
