/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
   SPDX-License-Identifier: Apache-2.0 */
/* The vehicle's generated PI controller in soft float, in a loop with a motor of first order. */
#include "functional.h"
#include "program.h"

#define SAMPLES 64

ExternalInputs_functional functional_U PLACE = {1.0F, 0.0F};
ExternalOutputs_functional functional_Y PLACE = {1.0F};
static float speeds[SAMPLES] PLACE = {1.0F};
word result;

static float wanted(int sample)
{
    return (float)((sample >> 4) * 3 - 4);
}

void run(void)
{
    float speed = 0.0F, sum = 0.0F;
    functional_initialize();
    for (int round = 0; round < ROUNDS; round++) {
        for (int sample = 0; sample < SAMPLES; sample++) {
            functional_U.Input_Voltage = wanted(sample);
            functional_U.Real_Voltage = speed / 2.029F;
            functional_step();
            speed += 0.1026F * (2.029F * functional_Y.correctedvoltage - speed);
            speeds[sample] = speed;
        }
        for (int sample = 0; sample < SAMPLES; sample++)
            sum = 0.5F * sum + speeds[sample];
    }
    result = (word)(int)(sum * 4096.0F);
}
