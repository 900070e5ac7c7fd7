/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
#ifndef HAND_RATES_H
#define HAND_RATES_H

typedef struct {
  float set_point;
  float angle;
  float speed;
} ExternalInputs_hand_rates;

typedef struct {
  float voltage;
} ExternalOutputs_hand_rates;

typedef struct {
  float wanted_speed;
  float filtered;
  float integral;
  int count;
} D_Work_hand_rates;

extern void hand_rates_initialize_instance(D_Work_hand_rates *work);
extern void hand_rates_step_instance(D_Work_hand_rates *work, const ExternalInputs_hand_rates *u,
  ExternalOutputs_hand_rates *y);

#endif
