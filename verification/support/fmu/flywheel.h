/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
   SPDX-License-Identifier: Apache-2.0 */
/* The mechanics of both test units: an NXT motor at its output shaft, with a flywheel of
   FLYWHEEL kg m^2. SI units; the motor's constants are macros of the command line. */

#ifndef FLYWHEEL
#define FLYWHEEL 0.004
#endif

enum { VOLTAGE = 0, ANGLE = 1 };

struct state {
    double voltage, angle, speed;
};

static inline void advance(struct state *state, double step)
{
    double current = (state->voltage - ELECTRIC_CONSTANT * state->speed) / RESISTANCE;
    double torque = TORQUE_CONSTANT * current - VISCOUS_FRICTION * state->speed;
    state->speed += step * torque / (INERTIA + FLYWHEEL);
    state->angle += step * state->speed;
}
