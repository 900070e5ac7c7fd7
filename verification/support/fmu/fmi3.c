/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
   SPDX-License-Identifier: Apache-2.0 */
/* The same unit for FMI 3.0.2: names, types and results of the standard's sections 2.2 and 4.2; of
   the functions, those do something that a co-simulation without events and intermediate values
   calls; the others refuse. */

#include "flywheel.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

typedef void *instance;
typedef const char *string;
typedef int status;

enum { OK = 0, ERROR = 3 };

string fmi3GetVersion(void) { return "3.0"; }

instance fmi3InstantiateCoSimulation(string name, string token, string resources, bool visible,
                                     bool logging, bool events, bool early_return,
                                     const uint32_t *intermediate, size_t count,
                                     void *environment, void *log, void *update)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)events;
    (void)early_return, (void)intermediate, (void)count, (void)environment, (void)log;
    (void)update;
    return calloc(1, sizeof(struct state));
}

void fmi3FreeInstance(instance unit) { free(unit); }

status fmi3EnterInitializationMode(instance unit, bool with_tolerance, double tolerance,
                                   double start, bool with_stop, double stop)
{
    return (void)unit, (void)with_tolerance, (void)tolerance, (void)start, (void)with_stop,
           (void)stop, OK;
}

status fmi3ExitInitializationMode(instance unit) { return (void)unit, OK; }
status fmi3Terminate(instance unit) { return (void)unit, OK; }

status fmi3SetFloat64(instance unit, const uint32_t *variables, size_t count,
                      const double *values, size_t value_count)
{
    for (size_t i = 0; i < count && i < value_count; i++) {
        if (variables[i] != VOLTAGE)
            return ERROR;
        ((struct state *)unit)->voltage = values[i];
    }
    return OK;
}

status fmi3GetFloat64(instance unit, const uint32_t *variables, size_t count, double *values,
                      size_t value_count)
{
    const struct state *state = unit;
    for (size_t i = 0; i < count && i < value_count; i++)
        values[i] = variables[i] == ANGLE ? state->angle : state->voltage;
    return OK;
}

status fmi3DoStep(instance unit, double now, double step, bool no_return, bool *event,
                  bool *terminate, bool *early, double *reached)
{
    (void)no_return;
    advance(unit, step);
    *event = *terminate = *early = false;
#ifdef ENDS_AT
    *terminate = now >= ENDS_AT;
#endif
    *reached = now + step;
    return OK;
}

#define ABSENT(name) \
    status name(instance unit) { return (void)unit, ERROR; }
ABSENT(fmi3ActivateModelPartition)
ABSENT(fmi3CompletedIntegratorStep)
ABSENT(fmi3DeserializeFMUState)
ABSENT(fmi3EnterConfigurationMode)
ABSENT(fmi3EnterContinuousTimeMode)
ABSENT(fmi3EnterEventMode)
ABSENT(fmi3EnterStepMode)
ABSENT(fmi3EvaluateDiscreteStates)
ABSENT(fmi3ExitConfigurationMode)
ABSENT(fmi3FreeFMUState)
ABSENT(fmi3GetAdjointDerivative)
ABSENT(fmi3GetBinary)
ABSENT(fmi3GetBoolean)
ABSENT(fmi3GetClock)
ABSENT(fmi3GetContinuousStateDerivatives)
ABSENT(fmi3GetContinuousStates)
ABSENT(fmi3GetDirectionalDerivative)
ABSENT(fmi3GetEventIndicators)
ABSENT(fmi3GetFMUState)
ABSENT(fmi3GetFloat32)
ABSENT(fmi3GetInt16)
ABSENT(fmi3GetInt32)
ABSENT(fmi3GetInt64)
ABSENT(fmi3GetInt8)
ABSENT(fmi3GetIntervalDecimal)
ABSENT(fmi3GetIntervalFraction)
ABSENT(fmi3GetNominalsOfContinuousStates)
ABSENT(fmi3GetNumberOfContinuousStates)
ABSENT(fmi3GetNumberOfEventIndicators)
ABSENT(fmi3GetNumberOfVariableDependencies)
ABSENT(fmi3GetOutputDerivatives)
ABSENT(fmi3GetShiftDecimal)
ABSENT(fmi3GetShiftFraction)
ABSENT(fmi3GetString)
ABSENT(fmi3GetUInt16)
ABSENT(fmi3GetUInt32)
ABSENT(fmi3GetUInt64)
ABSENT(fmi3GetUInt8)
ABSENT(fmi3GetVariableDependencies)
ABSENT(fmi3InstantiateModelExchange)
ABSENT(fmi3InstantiateScheduledExecution)
ABSENT(fmi3Reset)
ABSENT(fmi3SerializeFMUState)
ABSENT(fmi3SerializedFMUStateSize)
ABSENT(fmi3SetBinary)
ABSENT(fmi3SetBoolean)
ABSENT(fmi3SetClock)
ABSENT(fmi3SetContinuousStates)
ABSENT(fmi3SetDebugLogging)
ABSENT(fmi3SetFMUState)
ABSENT(fmi3SetFloat32)
ABSENT(fmi3SetInt16)
ABSENT(fmi3SetInt32)
ABSENT(fmi3SetInt64)
ABSENT(fmi3SetInt8)
ABSENT(fmi3SetIntervalDecimal)
ABSENT(fmi3SetIntervalFraction)
ABSENT(fmi3SetShiftDecimal)
ABSENT(fmi3SetShiftFraction)
ABSENT(fmi3SetString)
ABSENT(fmi3SetTime)
ABSENT(fmi3SetUInt16)
ABSENT(fmi3SetUInt32)
ABSENT(fmi3SetUInt64)
ABSENT(fmi3SetUInt8)
ABSENT(fmi3UpdateDiscreteStates)
