/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
#include "hand_rates.h"

void hand_rates_initialize_instance(D_Work_hand_rates *work)
{
  work->wanted_speed = 0.0F;
  work->filtered = 0.0F;
  work->integral = 0.0F;
  work->count = 0;
}

void hand_rates_step_instance(D_Work_hand_rates *work, const ExternalInputs_hand_rates *u,
  ExternalOutputs_hand_rates *y)
{
  float error;
  if (work->count == 0) {
    const float away = u->set_point - u->angle;
    const float smooth = (0.25F * away) + work->filtered;
    work->filtered = 0.75F * smooth;
    work->wanted_speed = (4.0F * smooth) + (0.5F * away);
  }
  error = work->wanted_speed - u->speed;
  y->voltage = (0.3125F * error) + work->integral;
  work->integral += 0.03125F * error;
  work->count = (work->count == 4) ? 0 : (work->count + 1);
}
