// What the views show: labels, thresholds, two volumes, the brush, a scene of the sea.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Bench } from "./bench.mjs";

let bench;
before(async () => {
  bench = await Bench.start();
});
after(() => bench?.stop());

const SIDE = 20;
const TORI = "source=demo:tori:24";

/** A file of numbers, one for each voxel of a cube, the first index along x. */
function numpy(name, kind, Values, value) {
  const values = new Values(SIDE ** 3);
  for (let n = 0; n < values.length; n++) values[n] = value(n % SIDE, Math.floor(n / SIDE) % SIDE, Math.floor(n / SIDE ** 2));
  const head = `{'descr': '${kind}', 'fortran_order': True, 'shape': (${SIDE}, ${SIDE}, ${SIDE}), }`.padEnd(117) + "\n";
  const file = join(bench.folder, name);
  writeFileSync(file, Buffer.concat([Buffer.from("\x93NUMPY\x01\x00v\x00", "latin1"), Buffer.from(head), Buffer.from(values.buffer)]));
  return { file, values };
}

const inside = () => bench.page.evaluate(() => window.shrouds.session.volume.inside);

/** Does something that changes what is inside, and waits until it is so many voxels. */
async function becomes(expected, doing) {
  await doing();
  await bench.page.waitForFunction((count) => window.shrouds.session.volume?.inside === count, expected);
}

test("the threshold slider says what is inside", async () => {
  const distance = (i, j, k) => 10 - Math.hypot(i - 9.5, j - 9.5, k - 9.5);
  const { file, values } = numpy("grey.npy", "<f4", Float32Array, distance);
  await bench.open(`source=${file}`);
  for (const level of [4, 6.5]) {
    const above = values.filter((value) => value > level).length;
    await becomes(above, () => bench.page.getByLabel("Threshold: inside is above").fill(String(level)));
  }
  await bench.page.waitForFunction(() => location.hash.includes("threshold=6.5"));
  await bench.settled();
});

test("labels are chosen one by one", async () => {
  const label = (i, j, k) => (Math.min(i, j, k) < 3 || Math.max(j, k) > 12 ? 0 : i < 8 ? 1 : i < 15 ? 2 : 0);
  const { file, values } = numpy("labels.npy", "|u1", Uint8Array, label);
  await bench.open(`source=${file}`);
  const count = (...labels) => values.filter((value) => labels.includes(value)).length;
  assert.equal(await inside(), count(1, 2));
  const box = (index) => bench.page.locator(".labels input").nth(index);
  // The background is the first of them.
  await becomes(count(1), () => box(2).uncheck());
  await becomes(count(0, 1), () => box(0).check());
});

test("two volumes are combined, and one is offset", async () => {
  await bench.open(`${TORI}&second=demo:ball:24`);
  await bench.page.waitForFunction(() => window.shrouds.session.volumes.has("b"));
  const counts = {};
  for (const sign of ["A ∪ B", "A ∩ B", "A ∖ B", "A ⊕ B"]) {
    await bench.resettled(() => bench.page.click(`button:text-is('${sign}')`));
    counts[sign] = await inside();
  }
  const [a, b] = await bench.page.evaluate(() => ["a", "b"].map((slot) => window.shrouds.session.volumes.get(slot).inside));
  assert.equal(counts["A ∪ B"] + counts["A ∩ B"], a + b);
  assert.equal(counts["A ∖ B"], a - counts["A ∩ B"]);
  assert.equal(counts["A ⊕ B"], counts["A ∪ B"] - counts["A ∩ B"]);
  await bench.resettled(() => bench.page.click(".segmented button:text-is('A')"));
  assert.equal(await inside(), a);
  const offset = async (by) => {
    await bench.page.getByLabel("Distance of the offset").fill(String(by));
    await bench.resettled(() => bench.page.click("button:text-is('Offset')"));
    return inside();
  };
  const grown = await offset(1);
  const back = await offset(-1);
  assert.ok(grown > back && back >= a, `${a}, ${grown}, ${back}`);
});

test("a stroke without Live runs no solver, and is taken back at once", async () => {
  await bench.open(`${TORI}&brush=true&brush-radius=2&live=false`);
  const first = await inside();
  const [x, y] = await bench.onSurface();
  await bench.page.mouse.move(x, y);
  await bench.page.mouse.down();
  for (const step of [1, 2, 3]) {
    const last = await inside();
    await bench.page.mouse.move(x + 12 * step, y);
    await bench.page.waitForFunction((old) => window.shrouds.session.volume.inside !== old, last);
  }
  await bench.page.mouse.up();
  await bench.numbers();
  const { state, iteration, surface } = await bench.view();
  assert.deepEqual([state, iteration, surface.followed], ["paused", 0, false]);
  await becomes(first, () => bench.page.keyboard.press("Control+z"));
});

test("with Live the surface follows the brush, and is solved as a whole after the stroke", async () => {
  await bench.open(`${TORI}&brush=true&brush-radius=2`);
  const { revision } = (await bench.view()).surface;
  await bench.page.mouse.move(...(await bench.onSurface()));
  await bench.page.mouse.down();
  await bench.page.waitForFunction((old) => window.shrouds.session.views[0].surface.revision > old, revision);
  const { surface, state } = await bench.view();
  assert.deepEqual([surface.followed, state], [true, "paused"]);
  await bench.page.mouse.up();
  await bench.page.waitForFunction(() => window.shrouds.session.views[0].state === "done");
  assert.equal((await bench.numbers()).wrong_side, 0);
});

test("a scene of the sea has a slider of time", async () => {
  await bench.open(TORI);
  await bench.page.click("summary:text-is('Sonar scene')");
  await bench.page.getByLabel("Path of a sonar scene").fill("figure11");
  await bench.resettled(() => bench.page.click("button:text-is('Load')"));
  const last = await inside();
  const time = bench.page.getByLabel("Time");
  assert.ok(Number(await time.getAttribute("max")) > 0);
  await bench.resettled(() => time.fill("0"));
  assert.notEqual(await inside(), last);
  assert.ok(await bench.page.evaluate(() => window.shrouds.stage.others.has("track")));
});

test("there was no error on the console", () => {
  assert.deepEqual(bench.errors, []);
});
