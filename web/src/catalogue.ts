// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The sensors of the catalogue, as host and core read them. */
import sensors from "../../catalogue/sensors.json";

interface SensorInput {
  name: string;
  manual_range?: number[];
  start?: number;
}

/** What can be plugged into a sensor port. */
export const SENSOR_KINDS = Object.keys(sensors);

const INPUTS: SensorInput[] = Object.values(sensors).flatMap((kind) => kind.inputs);

/** The input of a sensor that has this name at some port; faults are none. */
export function sensorInput(name: string): SensorInput | undefined {
  const pattern = name.replace(/^([a-z]+)\.\d/, "$1.{port}");
  return pattern.startsWith("fault.") ? undefined : INPUTS.find((input) => input.name === pattern);
}
