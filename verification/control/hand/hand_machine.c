/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
#include "hand_machine.h"

void hand_machine_initialize_instance(D_Work_hand_machine *work)
{
  work->state = hand_idle;
  work->since = 0;
}

void hand_machine_step_instance(D_Work_hand_machine *work, const ExternalInputs_hand_machine *u,
  ExternalOutputs_hand_machine *y)
{
  Hand_State state = work->state;
  int since = work->since;
  float speed;
  switch (state) {
    case hand_idle:
      if (u->start >= 0.5F) {
        state = hand_driving;
        since = 1;
        speed = 5.0F;
      } else {
        speed = 0.0F;
      }
      break;
    case hand_driving:
      if (u->distance < -2.0F) {
        state = hand_turning;
        since = 1;
        speed = -1.5F;
      } else if ((since >= 8) && (u->start < -6.0F)) {
        state = hand_stopped;
        since = 1;
        speed = 0.25F;
      } else {
        if (since < 8) {
          since++;
        }
        speed = 5.0F;
      }
      break;
    case hand_turning:
      if (since >= 3) {
        state = hand_driving;
        since = 1;
        speed = 5.0F;
      } else {
        since++;
        speed = -1.5F;
      }
      break;
    default:
      if (u->start > 6.0F) {
        state = hand_idle;
        since = 1;
        speed = 0.0F;
      } else {
        speed = 0.25F;
      }
      break;
  }
  work->state = state;
  work->since = since;
  y->speed = speed;
}
