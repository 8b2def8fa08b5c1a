import assert from "node:assert/strict";
import { test } from "node:test";

import { nearest, normalsOf, reduced } from "../../src/scene/mesh.ts";
import { sourceOf, sourceText } from "../../src/source.ts";

/** A square of n × n quads in the plane z = 0, facing +z, on a lattice of this spacing. */
function square(n: number, spacing: number): { positions: Float32Array; indices: Uint32Array } {
  const positions: number[] = [];
  const indices: number[] = [];
  for (let y = 0; y <= n; y++) for (let x = 0; x <= n; x++) positions.push(x * spacing, y * spacing, 0);
  const at = (x: number, y: number): number => y * (n + 1) + x;
  for (let y = 0; y < n; y++) {
    for (let x = 0; x < n; x++) {
      indices.push(at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1));
    }
  }
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
}

test("normals of a plane stand on it", () => {
  const { positions, indices } = square(3, 2);
  const normals = normalsOf(positions, indices);
  for (let vertex = 0; vertex < normals.length / 3; vertex++) {
    assert.deepEqual([...normals.subarray(3 * vertex, 3 * vertex + 2)], [0, 0]);
    assert.ok(normals[3 * vertex + 2]! > 0);
  }
});

test("a reduced mesh has a ninth of the triangles, between vertices of the mesh, facing the same way", () => {
  const { positions, indices } = square(30, 0.7);
  const fewer = reduced(positions, indices, [0.7, 0.7, 1]);
  const blocks = Math.ceil(31 / 3);
  assert.equal(fewer.length / 3, 2 * (blocks - 1) ** 2);
  assert.ok(fewer.every((vertex) => vertex < positions.length / 3));
  const normals = normalsOf(positions, fewer);
  assert.ok(normals.every((value, i) => (i % 3 === 2 ? value >= 0 : value === 0)));
  assert.ok(reduced(new Float32Array(), new Uint32Array(), [1, 1, 1]).length === 0);
});

test("the nearest vertex is found", () => {
  const { positions } = square(4, 1);
  assert.equal(nearest(positions, [3.2, 1.6, 5]), 2 * 5 + 3);
  assert.equal(nearest(new Float32Array(), [0, 0, 0]), -1);
});

test("sources are texts and back", () => {
  for (const text of ["demo:tori", "demo:tori:48", "demo:letters:AB:32", "/data/organs.nii.gz"]) {
    assert.equal(sourceText(sourceOf(text)), text);
  }
  assert.deepEqual(sourceOf("demo:letters:AB:32"), { demo: "letters:AB", size: 32 });
  assert.equal(sourceText({ upload: "7" }), "");
});
