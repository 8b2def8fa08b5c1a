// What is drawn and told beside the primal surface.

import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Bench, report } from "./bench.mjs";

let bench;
before(async () => {
  bench = await Bench.start();
});
after(() => bench?.stop());

const TORI = "source=demo:tori:24";

test("the dual mesh is that of the command line", async () => {
  await bench.open(`${TORI}&surface=dual`);
  const { topology } = report("demo", "tori", "--size", "24", "--surface", "dual", "-o", join(bench.folder, "dual"), "--json");
  const numbers = await bench.numbers();
  assert.equal(numbers.vertices, topology.vertices);
  assert.equal(numbers.triangles, topology.triangles);
  assert.ok(numbers.manifold && numbers.wrong_side === 0);
  const drawn = await bench.page.evaluate(() => window.shrouds.stage.panes[0].dual.count);
  assert.equal(drawn, topology.vertices);
});

test("the network is red, white and blue", async () => {
  await bench.open(`${TORI}&theme=dark&live=false`);
  const colours = async () => {
    const found = { red: 0, white: 0, blue: 0 };
    for (const pixel of await bench.pixels()) {
      const [r, g, b] = [pixel & 255, (pixel >> 8) & 255, (pixel >> 16) & 255];
      if (r - g > 90 && r - b > 70) found.red++;
      if (b - r > 50) found.blue++;
      if (Math.min(r, g, b) > 190) found.white++;
    }
    return found;
  };
  const bare = await colours();
  await bench.page.click("[data-look=network]");
  const lined = await colours();
  for (const name of ["red", "white", "blue"]) assert.ok(lined[name] > bare[name] + 50, `${name}: ${JSON.stringify([bare, lined])}`);
});

test("energies are compared, row by row", async () => {
  await bench.open(TORI);
  await bench.page.getByLabel("Energies to compare").fill("bending;length");
  await bench.page.click("button:text-is('Compare')");
  await bench.page.waitForFunction(() => window.shrouds.session.rows.length === 2);
  const { energies } = report("compare", "demo:tori", "--size", "24", "--energies", "bending;length", "--json");
  const rows = await bench.page.evaluate(() => window.shrouds.session.rows);
  assert.deepEqual(rows.map(({ value }) => value), energies.map(({ value }) => value));
  const names = bench.page.locator("table[aria-label='Energies compared'] tbody td:first-child");
  assert.deepEqual(await names.allTextContents(), ["bending", "length"]);
});

test("sizes come by themselves, and more bits take more bytes", async () => {
  await bench.open(TORI);
  const sizes = Object.values(await bench.packed());
  assert.equal(sizes.length, 5);
  assert.ok(sizes.every((size, n) => n === 0 || size > sizes[n - 1]), sizes.join());
});

test("a browser without WebGL is told so", async () => {
  const page = await bench.browser.newPage({ viewport: { width: 1280, height: 800 } });
  await page.addInitScript(() => {
    const own = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return kind.startsWith("webgl") ? null : own.call(this, kind, ...more);
    };
  });
  await page.goto(`${bench.address}#${TORI}`);
  await page.locator("#notice", { hasText: "no WebGL 2" }).waitFor();
  assert.match(await page.locator("#notice").textContent(), /shrouds mesh/);
  await page.close();
});

test("there was no error on the console", () => {
  assert.deepEqual(bench.errors, []);
});
