/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
   SPDX-License-Identifier: Apache-2.0 */
/* The mechanics of both test units: an NXT motor at its output shaft, with a flywheel of
   FLYWHEEL kg m^2. SI units. */

#ifndef FLYWHEEL
#define FLYWHEEL 0.004
#endif

enum { VOLTAGE = 0, ANGLE = 1 };

struct state {
    double voltage, angle, speed;
};

static inline void advance(struct state *state, double step)
{
    const double resistance = 6.8562, torque_constant = 0.31739, electric_constant = 0.46839;
    const double friction = 0.0011278, inertia = 0.000842 + FLYWHEEL;
    double current = (state->voltage - electric_constant * state->speed) / resistance;
    double torque = torque_constant * current - friction * state->speed;
    state->speed += step * torque / inertia;
    state->angle += step * state->speed;
}
