// The page in a real browser, with the real program behind it.

import assert from "node:assert/strict";
import { readFileSync, existsSync, statSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Bench, report } from "./bench.mjs";

let bench;
before(async () => {
  bench = await Bench.start();
});
after(() => bench?.stop());

const SIZE = 24;
const TORI = `source=demo:tori:${SIZE}`;

/** The report of the same shroud from the command line. */
function cli(...options) {
  return report("demo", "tori", "--size", String(SIZE), "-o", join(bench.folder, "demo"), "--json", ...options);
}

function sameAs(view, { topology, solver }) {
  assert.equal(view.surface.vertices, topology.vertices);
  assert.equal(view.surface.triangles, topology.triangles);
  assert.equal(view.iteration, solver.iterations);
  assert.equal(view.history.at(-1).energy, solver.energy.last);
}

test("a demo is shown, with the numbers of the command line", async () => {
  await bench.open(TORI);
  sameAs(await bench.view(), cli());
  const numbers = await bench.numbers();
  assert.equal(numbers.wrong_side, 0);
  assert.equal(numbers.manifold, true);
});

test("another energy gives another surface, that of the command line", async () => {
  await bench.resettled(() => bench.page.selectOption("[aria-label='Measure 1']", "linear"));
  sameAs(await bench.view(), cli("--energy", "linear"));
});

test("it steps, resets, and runs until it converges", async () => {
  await bench.open(`${TORI}&preset=exact&live=false`);
  assert.equal((await bench.view()).state, "paused");
  await bench.resettled(() => bench.page.keyboard.press("s"));
  assert.equal((await bench.view()).iteration, 1);
  await bench.resettled(() => bench.page.click("button:text-is('Reset')"));
  assert.equal((await bench.view()).iteration, 0);
  await bench.resettled(() => bench.page.click("button:has-text('▶ Run')"));
  const view = await bench.view();
  assert.equal(view.state, "done");
  sameAs(view, cli("--preset", "exact"));
  const [, ...steps] = view.history;
  assert.ok(steps.length > 1 && steps.every(({ gradient }) => gradient > 0));
});

test("each overlay changes the picture", async () => {
  await bench.open(`${TORI}&live=false`);
  for (const look of ["smooth", "network", "points", "wipe", "parallel"]) {
    const control = () => bench.page.click(`[data-look=${look}]`);
    assert.ok((await bench.changed(control)) > 1e-4, look);
    await control();
  }
  for (const [look, value] of [["contours", "z"], ["slice", "y"], ["clip", "x"], ["colours", "delta"]]) {
    const choose = (to) => bench.page.selectOption(`select[data-look=${look}]`, to);
    assert.ok((await bench.changed(() => choose(value))) > 1e-4, look);
    await choose("");
  }
});

test("a vertex can be picked", async () => {
  await bench.open(TORI);
  await bench.page.mouse.click(...(await bench.onSurface()));
  await bench.page.locator("dt", { hasText: "grid edge" }).waitFor();
});

test("a volume that is dropped is opened", async () => {
  const { topology } = report("demo", "ball", "--size", "20", "-o", join(bench.folder, "ball"), "--json");
  const file = join(bench.folder, "ball.nii.gz");
  report("combine", "union", join(bench.folder, "ball/volume.npy"), join(bench.folder, "ball/volume.npy"), "-o", file, "--json");
  await bench.open(TORI);
  const bytes = readFileSync(file).toString("base64");
  await bench.resettled(() =>
    bench.page.evaluate(async (text) => {
      const data = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
      const transfer = new DataTransfer();
      transfer.items.add(new File([data], "ball.nii.gz"));
      document.body.dispatchEvent(new DragEvent("drop", { bubbles: true, dataTransfer: transfer }));
    }, bytes),
  );
  const view = await bench.view();
  assert.equal(view.surface.vertices, topology.vertices);
});

test("the brush adds voxels, and undo takes them back", async () => {
  await bench.open(`${TORI}&brush=true&brush-radius=2`);
  const inside = () => bench.page.evaluate(() => window.shrouds.session.volume.inside);
  const first = await inside();
  await bench.page.mouse.move(...(await bench.onSurface()));
  await bench.page.mouse.down();
  await bench.page.waitForFunction((old) => window.shrouds.session.volume.inside > old, first);
  await bench.page.mouse.up();
  await bench.page.keyboard.press("Control+z");
  await bench.page.waitForFunction((old) => window.shrouds.session.volume.inside === old, first);
});

test("meshes, pictures and reports are saved, and the command line is that of the page", async () => {
  await bench.open(`${TORI}&energy=bending%2B0.3*variation`);
  const saved = async (doing) => {
    const [download] = await Promise.all([bench.page.waitForEvent("download"), doing()]);
    const path = join(bench.folder, download.suggestedFilename());
    await download.saveAs(path);
    return path;
  };
  await bench.page.selectOption("[data-out=format]", "ply");
  const mesh = await saved(() => bench.page.click("button:text-is('Save')"));
  const { vertices } = (await bench.view()).surface;
  assert.ok(readFileSync(mesh).includes(`element vertex ${vertices}`));
  const picture = await saved(() => bench.page.click("button:text-is('Picture')"));
  assert.ok(existsSync(picture) && statSync(picture).size > 5000);
  const json = await saved(() => bench.page.click("button:text-is('Report')"));
  assert.equal(JSON.parse(readFileSync(json)).topology.vertices, vertices);
  const command = bench.page.locator("[aria-label='The equivalent command line']");
  await bench.page.waitForFunction(() => document.querySelector("[aria-label='The equivalent command line']").value);
  assert.match(await command.inputValue(), /bending\+0\.3\*variation/);
});

test("four views stand side by side, each with its setting", async () => {
  await bench.open(`${TORI}&views=4&2.energy=linear&3.energy=length&4.start=random:3`);
  for (let view = 0; view < 4; view++) await bench.settled(view);
  const energies = await Promise.all([0, 1, 2].map(async (view) => (await bench.view(view)).history.at(-1).energy));
  assert.equal(new Set(energies).size, 3);
});

test("what cannot be is said, and the page goes on", async () => {
  await bench.open(`${TORI}&energy=beauty`, { settled: false });
  await bench.page.locator("#right .problem", { hasText: "beauty" }).waitFor();
  await bench.resettled(() => bench.page.evaluate(() => window.shrouds.store.choose(0, "energy", undefined)));
  assert.equal((await bench.view()).problem, "");
});

test("there was no error on the console", () => {
  assert.deepEqual(bench.errors, []);
});
