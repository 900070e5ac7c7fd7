/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
#ifndef HAND_MACHINE_H
#define HAND_MACHINE_H

typedef struct {
  float start;
  float distance;
} ExternalInputs_hand_machine;

typedef struct {
  float speed;
} ExternalOutputs_hand_machine;

typedef enum {
  hand_idle,
  hand_driving,
  hand_turning,
  hand_stopped
} Hand_State;

typedef struct {
  Hand_State state;
  int since;
} D_Work_hand_machine;

extern void hand_machine_initialize_instance(D_Work_hand_machine *work);
extern void hand_machine_step_instance(D_Work_hand_machine *work,
  const ExternalInputs_hand_machine *u, ExternalOutputs_hand_machine *y);

#endif
