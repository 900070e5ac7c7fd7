/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
   SPDX-License-Identifier: Apache-2.0 */
/* A co-simulation unit of FMI 2.0.4 for tests: a motor in port B that turns a flywheel. Input,
   value reference 0: voltage_B in V; output, value reference 1: angle_B in rad. The functions have
   the names, types and results of the standard's sections 2.1 and 4.2; of them, those are here
   that a co-simulation without events, strings and saved states calls; the others refuse. */

#include "flywheel.h"

#include <stddef.h>
#include <stdlib.h>

typedef void *component;
typedef unsigned int reference;
typedef double real;
typedef int integer, boolean, status;
typedef const char *string;

enum { OK = 0, ERROR = 3 };
const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }

component fmi2Instantiate(string name, integer kind, string guid, string resources,
                          const void *callbacks, boolean visible, boolean logging)
{
    (void)name, (void)kind, (void)guid, (void)resources;
    (void)callbacks, (void)visible, (void)logging;
    return calloc(1, sizeof(struct state));
}

void fmi2FreeInstance(component unit) { free(unit); }

status fmi2SetDebugLogging(component unit, boolean on, size_t count, const string *names)
{
    return (void)unit, (void)on, (void)count, (void)names, OK;
}

status fmi2SetupExperiment(component unit, boolean with_tolerance, real tolerance, real start,
                           boolean with_stop, real stop)
{
    return (void)unit, (void)with_tolerance, (void)tolerance, (void)start, (void)with_stop,
           (void)stop, OK;
}

status fmi2EnterInitializationMode(component unit) { return (void)unit, OK; }
status fmi2ExitInitializationMode(component unit) { return (void)unit, OK; }
status fmi2Terminate(component unit) { return (void)unit, OK; }

status fmi2Reset(component unit)
{
    *(struct state *)unit = (struct state){0};
    return OK;
}

status fmi2SetReal(component unit, const reference *variables, size_t count, const real *values)
{
    for (size_t i = 0; i < count; i++) {
        if (variables[i] != VOLTAGE)
            return ERROR;
        ((struct state *)unit)->voltage = values[i];
    }
    return OK;
}

status fmi2GetReal(component unit, const reference *variables, size_t count, real *values)
{
    const struct state *state = unit;
    for (size_t i = 0; i < count; i++)
        values[i] = variables[i] == ANGLE ? state->angle : state->voltage;
    return OK;
}

status fmi2DoStep(component unit, real now, real step, boolean no_return)
{
    (void)now, (void)no_return;
    advance(unit, step);
    return OK;
}

#define ABSENT(name) \
    status name(component unit) { return (void)unit, ERROR; }
ABSENT(fmi2GetInteger)
ABSENT(fmi2GetBoolean)
ABSENT(fmi2GetString)
ABSENT(fmi2SetInteger)
ABSENT(fmi2SetBoolean)
ABSENT(fmi2SetString)
ABSENT(fmi2GetFMUstate)
ABSENT(fmi2SetFMUstate)
ABSENT(fmi2FreeFMUstate)
ABSENT(fmi2SerializedFMUstateSize)
ABSENT(fmi2SerializeFMUstate)
ABSENT(fmi2DeSerializeFMUstate)
ABSENT(fmi2GetDirectionalDerivative)
ABSENT(fmi2SetRealInputDerivatives)
ABSENT(fmi2GetRealOutputDerivatives)
ABSENT(fmi2CancelStep)
ABSENT(fmi2GetStatus)
ABSENT(fmi2GetRealStatus)
ABSENT(fmi2GetIntegerStatus)
ABSENT(fmi2GetBooleanStatus)
ABSENT(fmi2GetStringStatus)
