/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/* What an application of the generated controller defines. */
#include "functional.h"

ExternalInputs_functional functional_U;
ExternalOutputs_functional functional_Y;

void run_step(void)
{
  functional_step();
}
