import assert from "node:assert/strict";
import { test } from "node:test";

import { decode, segmentsOf, type Lines } from "../../src/frames.ts";

/** A frame from its header and the parts of its payload. */
function frame(header: [number, number, number, number], ...parts: ArrayBufferView[]): ArrayBuffer {
  const all = [new Uint32Array(header), ...parts];
  const bytes = new Uint8Array(all.reduce((sum, part) => sum + part.byteLength, 0));
  let at = 0;
  for (const part of all) {
    bytes.set(new Uint8Array(part.buffer, part.byteOffset, part.byteLength), at);
    at += part.byteLength;
  }
  return bytes.buffer;
}

const floats = (...values: number[]): Float32Array => Float32Array.from(values);
const numbers = (...values: number[]): Uint32Array => Uint32Array.from(values);

const topology = frame(
  [1, 2, 7, 2],
  numbers(2, 1, 3, 0),
  floats(1, 2, 3, 4, 5, 6),
  floats(1, 0, 0, 0, -1, 0),
  numbers(0, 1, 0),
  numbers(0, 1, 1, 0, 5, 6),
  Uint8Array.of(2, 0, 2, 0),
);

test("a topology has edges, triangles and segments by family", () => {
  const read = decode(topology);
  assert.equal(read.kind, "topology");
  if (read.kind !== "topology") return;
  assert.deepEqual([read.view, read.revision], [2, 7]);
  assert.deepEqual([...read.outside], [1, 2, 3, 4, 5, 6]);
  assert.deepEqual([...read.along], [1, 0, 0, 0, -1, 0]);
  assert.deepEqual([...read.indices], [0, 1, 0]);
  assert.deepEqual(read.families.map((family) => [...family]), [[1, 0], [], [0, 1, 5, 6]]);
});

test("δ, normals and scalars are counted by vertex", () => {
  const delta = decode(frame([2, 0, 1, 3], floats(0, 0.5, 1)));
  assert.deepEqual(delta.kind === "delta" && [...delta.values], [0, 0.5, 1]);
  const normals = decode(frame([5, 0, 1, 1], floats(0, 0, 1)));
  assert.deepEqual(normals.kind === "normals" && [...normals.values], [0, 0, 1]);
});

test("points carry their side", () => {
  const side = numbers(1, 0);
  const data = [floats(1, 2, 3), side.subarray(0, 1), floats(4, 5, 6), side.subarray(1)];
  const points = decode(frame([8, 0, 4, 2], ...data));
  assert.deepEqual(points.kind === "points" && [...points.points], [1, 2, 3, 4, 5, 6]);
  assert.deepEqual(points.kind === "points" && [...points.inside], [1, 0]);
});

test("an image has as many pixels as it says", () => {
  const pixels = Uint8Array.from({ length: 8 }, (_, i) => i);
  const corners = new Float32Array(9);
  const image = decode(frame([9, 0, 4, 2], numbers(2, 1), corners, pixels));
  assert.deepEqual(image.kind === "image" && [...image.pixels], [0, 1, 2, 3, 4, 5, 6, 7]);
  assert.throws(() => decode(frame([9, 0, 4, 2], numbers(2, 2), corners, pixels)), /too early/);
});

test("polylines become segments", () => {
  const points = floats(...Array(15).fill(0).map((_, i) => i));
  const lines = decode(frame([7, 0, 4, 2], numbers(2, 3, 2), points)) as Lines;
  assert.deepEqual([...segmentsOf(lines)], [0, 1, 1, 2, 3, 4]);
  assert.throws(() => segmentsOf({ ...lines, lengths: numbers(3) }), /do not fit/);
});

test("interfaces have runs of triangles and edges", () => {
  const data = [numbers(2, 1), numbers(1, 0, 5, 2, 1, 4), numbers(7, 8)];
  const read = decode(frame([10, 0, 4, 2], ...data));
  assert.deepEqual(read.kind === "interfaces" && [[...read.runs], [...read.edges]], [[1, 0, 5, 2, 1, 4], [7, 8]]);
  assert.throws(() => decode(frame([10, 0, 4, 2], numbers(2, 0xffffffff))), /too early/);
});

test("every cut-off frame is an error, and nothing is allocated by a count that lies", () => {
  for (let length = 0; length < topology.byteLength; length++) {
    assert.throws(() => decode(topology.slice(0, length)), `${length} bytes`);
  }
  assert.throws(() => decode(frame([2, 0, 1, 0xffffffff])), /too early/);
  assert.throws(() => decode(frame([8, 0, 1, 0xffffffff])), /too early|Invalid/);
  assert.throws(() => decode(frame([77, 0, 0, 0])), /unknown kind 77/);
  const family = frame([1, 0, 0, 0], numbers(0, 0, 1, 0), numbers(0, 0), Uint8Array.of(3, 0, 0, 0));
  assert.throws(() => decode(family), /across axis 3/);
});
