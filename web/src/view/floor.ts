// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The vehicle seen from above, with its path. */
import { colour, el, panel, surface } from "../dom";
import type { Frame, Ready } from "../protocol";
import type { Surroundings } from "../session";
import type { View } from "./view";

const PATH_POINTS_MAX = 20_000;
const POINT_DISTANCE = 0.005;
const MARGIN = 0.3;

interface Point {
  x: number;
  y: number;
}

interface Pose extends Point {
  heading: number;
}

/** The floor's picture, a pixel each. */
function pictureOf({ floor }: Surroundings): HTMLCanvasElement | null {
  if (!floor || floor.width < 1) return null;
  const height = Math.floor(floor.reflectance.length / floor.width);
  const canvas = el("canvas", { width: floor.width, height });
  const context = canvas.getContext("2d");
  if (!context || height < 1) return null;
  const image = context.createImageData(floor.width, height);
  floor.reflectance.forEach((value, at) => image.data.set([value, value, value, 255], 4 * at));
  context.putImageData(image, 0, 0);
  return canvas;
}

export class Floor implements View {
  readonly element: HTMLElement;
  private readonly canvas = el("canvas", {
    id: "floor-view",
    role: "img",
    "aria-label": "Vehicle from above with its path",
  });
  private readonly text = el("output", { id: "pose", "aria-label": "Position and heading" }, "");
  private path: Pose[] = [];
  private pose: Pose | null = null;
  private track = 0.115;
  private surroundings: Surroundings = {};
  private picture: HTMLCanvasElement | null = null;

  constructor() {
    this.element = panel("floor", "Floor", [this.text], this.canvas);
  }

  ready({ session, channels }: Ready): void {
    this.element.hidden = !channels.signals.includes("body.x");
    this.track = session.configuration.body?.track ?? this.track;
    this.surroundings = session.configuration.surroundings ?? {};
    this.picture = pictureOf(this.surroundings);
    this.path = [];
    this.pose = null;
    this.draw();
  }

  frame({ signals }: Frame): void {
    const [x, y, heading] = [signals["body.x"], signals["body.y"], signals["body.heading"]];
    if (x == null || y == null || heading == null) return;
    this.pose = { x, y, heading };
    const last = this.path.at(-1);
    if (!last || Math.hypot(last.x - x, last.y - y) >= POINT_DISTANCE) this.path.push(this.pose);
    // A long path keeps every second point: its shape stays.
    if (this.path.length > PATH_POINTS_MAX) this.path = this.path.filter((_, at) => at % 2 === 0);
    const turned = ((heading * 180) / Math.PI).toFixed(0);
    this.text.value = `x ${x.toFixed(2)} m, y ${y.toFixed(2)} m, ${turned}°`;
    this.draw();
  }

  private draw(): void {
    const drawing = surface(this.canvas);
    if (!drawing) return;
    const { context, width, height } = drawing;
    const shown = [...this.path, { x: 0, y: 0 }, ...this.corners()];
    const bounds = (pick: (point: Point) => number) => {
      const values = shown.map(pick);
      return [Math.min(...values) - MARGIN, Math.max(...values) + MARGIN] as const;
    };
    const [left, right] = bounds((pose) => pose.x);
    const [low, high] = bounds((pose) => pose.y);
    const scale = Math.min(width / (right - left), height / (high - low));
    context.translate(width / 2, height / 2);
    context.scale(scale, -scale);
    context.translate(-(left + right) / 2, -(low + high) / 2);
    this.drawPicture(context);
    this.grid(context, scale, Math.max(right - left, high - low) * 2);
    this.drawWalls(context, scale);
    context.lineWidth = 2 / scale;
    context.strokeStyle = colour("accent");
    context.beginPath();
    for (const { x, y } of this.path) context.lineTo(x, y);
    context.stroke();
    if (this.pose) this.vehicle(context, this.pose, scale);
  }

  /** What is to be seen besides the path. */
  private corners(): Point[] {
    const { floor, walls } = this.surroundings;
    const ends = (walls ?? []).flatMap(({ from, to }) => [from, to]);
    const points = ends.map(([x, y]) => ({ x, y }));
    if (floor && this.picture) {
      const [x, y] = floor.corner;
      const { width, height } = this.picture;
      points.push({ x, y }, { x: x + width * floor.pixel, y: y + height * floor.pixel });
    }
    return points;
  }

  private drawPicture(context: CanvasRenderingContext2D): void {
    const { floor } = this.surroundings;
    if (!floor || !this.picture) return;
    const [x, y] = floor.corner;
    const { height } = this.picture;
    context.save();
    // Its first row is the uppermost; y grows upwards here.
    context.translate(x, y + height * floor.pixel);
    context.scale(floor.pixel, -floor.pixel);
    context.drawImage(this.picture, 0, 0);
    context.restore();
  }

  private drawWalls(context: CanvasRenderingContext2D, scale: number): void {
    context.lineWidth = 4 / scale;
    context.strokeStyle = colour("ink");
    context.beginPath();
    for (const { from, to } of this.surroundings.walls ?? []) {
      context.moveTo(...from);
      context.lineTo(...to);
    }
    context.stroke();
  }

  private grid(context: CanvasRenderingContext2D, scale: number, size: number): void {
    const step = scale > 60 ? 0.5 : 1;
    context.lineWidth = 1 / scale;
    context.strokeStyle = colour("grid");
    context.beginPath();
    for (let at = -Math.ceil(size / step) * step; at <= size; at += step) {
      context.moveTo(at, -size);
      context.lineTo(at, size);
      context.moveTo(-size, at);
      context.lineTo(size, at);
    }
    context.stroke();
  }

  private vehicle(context: CanvasRenderingContext2D, pose: Pose, scale: number): void {
    const half = this.track / 2;
    // Never smaller than a few pixels on a wide floor.
    const enlarge = Math.max(1, 14 / (scale * this.track));
    context.translate(pose.x, pose.y);
    context.rotate(pose.heading);
    context.scale(enlarge, enlarge);
    context.fillStyle = colour("ink");
    context.fillRect(-half, -half, this.track * 1.4, this.track);
    context.fillStyle = colour("accent");
    context.beginPath();
    context.moveTo(half * 1.6, 0);
    context.lineTo(half * 0.6, half * 0.6);
    context.lineTo(half * 0.6, -half * 0.6);
    context.fill();
    context.fillStyle = colour("grid");
    for (const side of [-1, 1]) context.fillRect(-half * 0.5, side * half - 0.012, half, 0.024);
  }
}
