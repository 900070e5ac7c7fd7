/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
#include "hand_delay.h"

void hand_delay_initialize_instance(D_Work_hand_delay *work)
{
  unsigned int place;
  for (place = 0U; place < 100U; place++) {
    work->samples[place] = 0.0F;
  }
  work->oldest = 0U;
}

void hand_delay_step_instance(D_Work_hand_delay *work, const ExternalInputs_hand_delay *u,
  ExternalOutputs_hand_delay *y)
{
  float *const sample = &work->samples[work->oldest];
  y->late = *sample;
  *sample = u->value;
  work->oldest = (work->oldest == 99U) ? 0U : (work->oldest + 1U);
}
