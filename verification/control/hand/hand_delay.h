/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
#ifndef HAND_DELAY_H
#define HAND_DELAY_H

typedef struct {
  float value;
} ExternalInputs_hand_delay;

typedef struct {
  float late;
} ExternalOutputs_hand_delay;

typedef struct {
  float samples[100];
  unsigned int oldest;
} D_Work_hand_delay;

extern void hand_delay_initialize_instance(D_Work_hand_delay *work);
extern void hand_delay_step_instance(D_Work_hand_delay *work, const ExternalInputs_hand_delay *u,
  ExternalOutputs_hand_delay *y);

#endif
