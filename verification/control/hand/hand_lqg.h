/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
#ifndef HAND_LQG_H
#define HAND_LQG_H

typedef struct {
  float angle;
  float speed;
} ExternalInputs_hand_lqg;

typedef struct {
  float voltage;
} ExternalOutputs_hand_lqg;

typedef struct {
  float x1;
  float x2;
  float x3;
  float x4;
} D_Work_hand_lqg;

extern void hand_lqg_initialize_instance(D_Work_hand_lqg *work);
extern void hand_lqg_step_instance(D_Work_hand_lqg *work, const ExternalInputs_hand_lqg *u,
  ExternalOutputs_hand_lqg *y);

#endif
