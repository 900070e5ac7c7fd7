// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0

import lejos.nxt.*;
public class Proof {
  public static void main(String[] args) throws Exception {
    LCD.drawString("Java begins", 0, 0);
    Motor.A.setSpeed(360);
    Motor.A.rotate(360);
    LCD.drawString("angle " + Motor.A.getTachoCount(), 0, 1);
    TouchSensor touch = new TouchSensor(SensorPort.S1);
    while (!touch.isPressed()) Thread.sleep(10);
    LCD.drawString("pressed", 0, 2);
    Sound.playTone(880, 300);
    Thread.sleep(600);
    LCD.drawString("done", 0, 3);
    while (true) Thread.sleep(100);
  }
}
