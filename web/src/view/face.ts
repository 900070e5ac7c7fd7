// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The brick's face: the display, pixel by pixel, and the four buttons. */
import { el, panel } from "../dom";
import type { Frame } from "../protocol";
import { holdButton } from "./control";
import type { Actions, View } from "./view";

const COLUMNS = 100;
const ROWS = 64;
const BUTTONS = [
  ["left", "◀", "Left button (arrow left)"],
  ["orange", "■", "Orange button (Enter)"],
  ["right", "▶", "Right button (arrow right)"],
  ["grey", "▬", "Grey button (Escape)"],
] as const;

export class Face implements View {
  readonly element: HTMLElement;
  private readonly screen = el("canvas", {
    id: "lcd",
    width: COLUMNS,
    height: ROWS,
    role: "img",
    "aria-label": "Display of the brick, 100 by 64 pixels",
  });

  constructor(actions: Actions) {
    const buttons = BUTTONS.map(([name, sign, label]) =>
      holdButton(sign, { "aria-label": label, class: `brick-${name}` }, (down) =>
        actions.input(`button.${name}`, down ? 1 : 0),
      ),
    );
    const keys = el("div", { class: "brick-buttons" }, ...buttons);
    this.element = panel("face", "Brick", [], el("div", { class: "brick" }, this.screen, keys));
  }

  ready(): void {
    this.draw(new Uint8Array(COLUMNS * ROWS));
  }

  frame({ lcd }: Frame): void {
    if (lcd) this.draw(lcd);
  }

  private draw(pixels: Uint8Array): void {
    const context = this.screen.getContext("2d");
    if (!context) return;
    const image = context.createImageData(COLUMNS, ROWS);
    const words = new Uint32Array(image.data.buffer);
    // Little-endian RGBA: dark ink on the glass.
    pixels.forEach((pixel, at) => (words[at] = pixel ? 0xff22_2a1e : 0xff8f_b5a6));
    context.putImageData(image, 0, 0);
  }
}
