/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
#ifndef HAND_PI_H
#define HAND_PI_H

typedef struct {
  float set_point;
  float measured;
} ExternalInputs_hand_pi;

typedef struct {
  float voltage;
} ExternalOutputs_hand_pi;

typedef struct {
  float integral;
} D_Work_hand_pi;

extern void hand_pi_initialize_instance(D_Work_hand_pi *work);
extern void hand_pi_step_instance(D_Work_hand_pi *work, const ExternalInputs_hand_pi *u,
  ExternalOutputs_hand_pi *y);

#endif
