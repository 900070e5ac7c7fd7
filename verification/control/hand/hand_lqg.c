/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
#include "hand_lqg.h"

void hand_lqg_initialize_instance(D_Work_hand_lqg *work)
{
  work->x1 = 0.0F;
  work->x2 = 0.0F;
  work->x3 = 0.0F;
  work->x4 = 0.0F;
}

void hand_lqg_step_instance(D_Work_hand_lqg *work, const ExternalInputs_hand_lqg *u,
  ExternalOutputs_hand_lqg *y)
{
  const float x1 = work->x1;
  const float x2 = work->x2;
  const float x3 = work->x3;
  const float x4 = work->x4;
  const float angle = u->angle;
  const float speed = u->speed;
  y->voltage = (-1.25F * x1) + (-0.5F * x2) + (2.75F * x3) + (-0.375F * x4);
  work->x1 = (0.71F * x1) + (0.04F * x2) + (-0.02F * x3) + (0.01F * x4) + (0.28F * angle)
    + (0.03F * speed);
  work->x2 = (-0.35F * x1) + (0.62F * x2) + (0.15F * x3) + (-0.05F * x4) + (0.22F * angle)
    + (0.31F * speed);
  work->x3 = (0.05F * x1) + (-0.11F * x2) + (0.83F * x3) + (0.04F * x4) + (0.07F * angle)
    + (-0.02F * speed);
  work->x4 = (-0.21F * x1) + (0.09F * x2) + (-0.18F * x3) + (0.55F * x4) + (0.13F * angle)
    + (0.24F * speed);
}
