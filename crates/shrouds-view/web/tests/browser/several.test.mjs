// Several labels in a view: their interfaces, colours, junction lines and numbers.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Bench, report } from "./bench.mjs";

let bench;
before(async () => {
  bench = await Bench.start();
});
after(() => bench?.stop());

const CELLS = "source=demo:cells:24";

/** The report of the same interfaces from the command line, and its mesh. */
function cli(...options) {
  const folder = join(bench.folder, "cells");
  report("demo", "cells", "--size", "24", "-o", folder, "--json");
  const mesh = join(folder, "all.ply");
  return { mesh, ...report("mesh", join(folder, "volume.npy"), "--materials", "-o", mesh, "--json", ...options) };
}

const tableRows = (name) => bench.page.locator(`table[aria-label='${name}'] tbody tr`).count();

test("all labels are shown, with the numbers and the bytes of the command line", async () => {
  await bench.open(CELLS);
  await bench.numbers();
  await bench.resettled(() => bench.page.click("button:text-is('All labels')"));
  const numbers = await bench.numbers();
  const { mesh, topology, labels } = cli();
  assert.deepEqual([numbers.vertices, numbers.triangles], [topology.vertices, topology.triangles]);
  const { crossings, junctions, junction_lines: lines } = numbers.materials;
  assert.deepEqual([crossings, junctions], [topology.crossings, topology.junction_points]);
  assert.ok(numbers.wrong_side === 0 && numbers.manifold);
  assert.equal(await tableRows("Numbers of the labels"), labels.length);
  assert.ok((await tableRows("Largest contacts")) > 5);
  const drawn = await bench.page.evaluate(() => {
    const { several, surface } = window.shrouds.stage.panes[0];
    return [surface.topology.indices.length / 3, several.edges];
  });
  assert.deepEqual(drawn, [topology.triangles, lines]);
  await bench.page.selectOption("[data-out=format]", "ply");
  const [download] = await Promise.all([bench.page.waitForEvent("download"), bench.page.click("button:text-is('Save')")]);
  const path = join(bench.folder, "saved.ply");
  await download.saveAs(path);
  assert.ok(readFileSync(path).equals(readFileSync(mesh)));
  await bench.page.waitForFunction(() =>
    document.querySelector("[aria-label='The equivalent command line']").value.includes("--materials"),
  );
  await bench.page.waitForFunction(() => location.hash.includes("materials=true"));
});

test("each label has the colour of the list, and can be hidden", async () => {
  const colours = async () => {
    const found = new Map();
    const wanted = await bench.page.evaluate(() => window.shrouds.session.volume.labels.map(({ value, colour }) => [value, colour]));
    const hue = ([r, g, b]) => {
      const most = Math.max(r, g, b);
      return most - Math.min(r, g, b) < 20 ? [0, 0, 0] : [r, g, b].map((part) => part / most);
    };
    const pixels = (await bench.pixels()).map((pixel) => hue([pixel & 255, (pixel >> 8) & 255, (pixel >> 16) & 255]));
    for (const [label, colour] of wanted.filter(([value]) => value > 0)) {
      const own = hue([0, 2, 4].map((at) => Number.parseInt(colour.slice(at, at + 2), 16)));
      const near = (seen) => Math.hypot(...seen.map((part, at) => part - own[at])) < 0.04;
      found.set(label, pixels.filter(near).length);
    }
    return found;
  };
  const before = await colours();
  const [largest, count] = [...before].sort((a, b) => b[1] - a[1])[0];
  assert.ok(count > 200, JSON.stringify([...before]));
  const toggle = bench.page.getByRole("button", { name: `Show the boundary of label ${largest}`, exact: true });
  assert.equal(await toggle.getAttribute("aria-pressed"), "true");
  const lines = () => bench.page.evaluate(() => window.shrouds.stage.panes[0].several.edges);
  const all = await lines();
  assert.ok((await bench.changed(() => toggle.click())) > 1e-3);
  assert.equal(await toggle.getAttribute("aria-pressed"), "false");
  assert.ok((await colours()).get(largest) < count / 4);
  await bench.page.waitForFunction((label) => location.hash.includes(`hidden=${label}`), largest);
  assert.ok((await lines()) <= all);
  await bench.page.click("button:text-is('Show all')");
  assert.equal(await lines(), all);
});

test("what interfaces have not cannot be pressed and says why", async () => {
  const off = ["button:text-is('Step')", "button:text-is('Reset')", "button:text-is('Sizes')", "[data-look=network]", "select[data-look=colours]", "[data-setting=solver]"];
  for (const control of off) {
    const found = bench.page.locator(control).first();
    assert.equal(await found.isDisabled(), true, control);
    assert.match(await found.getAttribute("title"), /several labels/, control);
  }
  assert.equal(await bench.page.locator("[data-look=brush]").isDisabled(), true);
  assert.equal(await bench.page.locator("[data-setting=preset]").isDisabled(), false);
  await bench.page.keyboard.press("s");
  await bench.page.locator("#messages", { hasText: "in one piece" }).waitFor();
});

test("the address brings them back, with some labels and without Live", async () => {
  await bench.open(`${CELLS}&labels=1,6,8&materials=true&preset=exact&live=false`, { settled: false });
  await bench.page.locator("#solver-state", { hasText: "run it" }).waitFor();
  await bench.resettled(() => bench.page.click("button:has-text('▶ Run')"));
  const { surface } = await bench.view();
  assert.deepEqual(surface.materials, [0, 1, 6, 8]);
  const { topology, checks } = cli("--preset", "exact", "--label", "1", "--label", "6", "--label", "8");
  const numbers = await bench.numbers();
  assert.deepEqual([numbers.vertices, numbers.triangles, checks.wrong_label], [topology.vertices, topology.triangles, 0]);
  // One label is too few, and says so; as one body it is enough.
  await bench.page.click("button:text-is('None')");
  await bench.page.locator(".labels input").nth(6).check();
  await bench.page.locator("#right .problem", { hasText: "at least two" }).waitFor();
  await bench.page.click("button:text-is('One body')");
  await bench.settled();
  assert.equal((await bench.view()).surface.materials, undefined);
});

test("one body and several labels stand side by side", async () => {
  await bench.open(`${CELLS}&views=2&2.materials=true`);
  await bench.settled(1);
  const [one, several] = [await bench.numbers(0), await bench.numbers(1)];
  assert.equal(one.materials, undefined);
  assert.equal(several.materials.labels.length, 12);
  await bench.page.selectOption("select[data-look=contours]", "z");
  await bench.page.waitForFunction(() => window.shrouds.stage.panes[0].contours);
});

test("volumes without labels say so, and the way back is there", async () => {
  await bench.open("source=demo:ball:16&materials=true", { settled: false });
  await bench.page.locator("#right .problem", { hasText: "no labels" }).waitFor();
  await bench.resettled(() => bench.page.click("button:text-is('One body')"));
  assert.equal((await bench.view()).problem, "");
});

test("there was no error on the console", () => {
  assert.deepEqual(bench.errors, []);
});
