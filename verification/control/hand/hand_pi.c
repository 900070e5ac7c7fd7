/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
#include "hand_pi.h"

/* Tunable gains. */
typedef struct {
  float proportional;
  float integral;
  float tracking;
  float limit;
} Gains;

extern Gains pi;
Gains pi = { 0.314445F, 0.032221F, 0.10810811F, 8.0F };

void hand_pi_initialize_instance(D_Work_hand_pi *work)
{
  work->integral = 0.0F;
}

void hand_pi_step_instance(D_Work_hand_pi *work, const ExternalInputs_hand_pi *u,
  ExternalOutputs_hand_pi *y)
{
  const float error = u->set_point - u->measured;
  const float demand = (pi.proportional * error) + work->integral;
  float voltage = demand;
  if (demand > pi.limit) {
    voltage = pi.limit;
  } else if (demand < -pi.limit) {
    voltage = -pi.limit;
  }
  work->integral += (pi.integral * error) + (pi.tracking * (voltage - demand));
  y->voltage = voltage;
}
