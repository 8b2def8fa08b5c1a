// How long a user waits: `npm run measure -- brain.nii.gz`, with the program and the browser of the tests. Clock times, so
// they mean something on a machine at rest only: how busy it is is printed first.

import { loadavg, cpus } from "node:os";
import { resolve } from "node:path";
import { Bench } from "./bench.mjs";

const ROUNDS = 5;
const STEPS = 20;

const middle = (values) => values.toSorted((a, b) => a - b)[values.length >> 1];
const told = (values) => `${middle(values).toFixed(0)} ms (${values.map((value) => value.toFixed(0)).join(", ")})`;

/** From the start of the navigation, in a browser that has just been started, to two frames after the surface is there. */
async function firstPicture(source) {
  const bench = await Bench.start();
  const page = await bench.browser.newPage({ viewport: { width: 1280, height: 800 } });
  await page.addInitScript(() => {
    let frames = 0;
    const look = (now) => {
      if (window.shrouds?.stage.positions(0)) frames++;
      if (frames > 2) window.first = now;
      else requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  });
  await page.goto(`${bench.address}#source=${source}`);
  const first = await (await page.waitForFunction(() => window.first)).jsonValue();
  await bench.stop();
  return first;
}

/** From when a solver hands out positions to when the page has given them to the graphics card, step by step. */
async function updates(source) {
  const bench = await Bench.start();
  await bench.open(`source=${source}&live=false`);
  await bench.packed();
  const ways = [];
  for (let step = 0; step < STEPS; step++) {
    await bench.page.evaluate(() => (window.shrouds.session.views[0].way = null));
    await bench.page.keyboard.press("s");
    await bench.settled();
    // The last step of all finds nothing more to do.
    const { way } = await bench.view();
    if (way !== null) ways.push(way);
    // Until the picture has been drawn and the numbers are there.
    await bench.packed();
  }
  await bench.stop();
  return ways;
}

const volume = process.argv[2] && resolve(process.env.INIT_CWD ?? ".", process.argv[2]);
console.log(`${cpus().length} processors, ${loadavg()[0].toFixed(1)} tasks that want them`);
for (const source of ["demo:tori:64", volume].filter(Boolean)) {
  const firsts = [];
  for (let round = 0; round < ROUNDS; round++) firsts.push(await firstPicture(source));
  console.log(`${source}: first picture ${told(firsts)}`);
  console.log(`${source}: a step from the solver to the graphics card ${told(await updates(source))}`);
}
