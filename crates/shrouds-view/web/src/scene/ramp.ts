// Colours of numbers.

import { DataTexture, LinearFilter } from "three";
import type { Colouring } from "../protocol.ts";

/** 256 colours between the stops of a legend. */
export function ramp({ legend, low, high }: Colouring): DataTexture {
  const pixels = new Uint8Array(4 * 256);
  const stops = legend.map(([value, text]) => [value, hex(text)] as const);
  for (let i = 0; i < 256; i++) {
    const value = low + ((high - low) * i) / 255;
    const after = Math.max(stops.findIndex(([stop]) => stop >= value), 0);
    const [right, to] = stops[after] ?? [value, [0, 0, 0]];
    const [left, from] = stops[Math.max(after - 1, 0)] ?? [value, [0, 0, 0]];
    const share = right > left ? (value - left) / (right - left) : 0;
    pixels.set([...from.map((c, k) => c + share * ((to[k] ?? c) - c)), 255], 4 * i);
  }
  const texture = new DataTexture(pixels, 256, 1);
  Object.assign(texture, { magFilter: LinearFilter, minFilter: LinearFilter });
  texture.needsUpdate = true;
  return texture;
}

function hex(text: string): number[] {
  const digits = text.replace("#", "");
  return [0, 2, 4].map((at) => Number.parseInt(digits.slice(at, at + 2), 16) || 0);
}
