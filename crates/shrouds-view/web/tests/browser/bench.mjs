// The program and a browser for the tests, and what they do with both.

import { spawn, execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const PROGRAM = process.env.SHROUDS_BIN;
const BROWSER = process.env.SHROUDS_CHROMIUM ?? "/usr/bin/chromium";
const FLAGS = [
  "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
];
/** Software draws the pictures, on machines that are busy. */
export const PATIENCE = 60_000;

/** What the program prints, as JSON. */
export function report(...call) {
  return JSON.parse(execFileSync(PROGRAM, call, { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] }));
}

export class Bench {
  /** Errors on the console and those that nobody caught. */
  errors = [];

  static async start() {
    const bench = new Bench();
    bench.folder = mkdtempSync(join(tmpdir(), "shrouds-page-"));
    bench.program = spawn(PROGRAM, ["view", "--no-open"], { stdio: ["ignore", "pipe", "inherit"] });
    bench.address = await new Promise((resolve, reject) => {
      let text = "";
      bench.program.stdout.on("data", (part) => {
        text += part;
        const found = /http:\S+/.exec(text);
        if (found) resolve(found[0]);
      });
      bench.program.on("exit", (code) => reject(new Error(`shrouds view ended with ${code}`)));
    });
    bench.browser = await chromium.launch({ executablePath: BROWSER, args: FLAGS });
    return bench;
  }

  async stop() {
    await this.browser?.close();
    this.program.kill("SIGINT");
    rmSync(this.folder, { recursive: true, force: true });
  }

  /** A page with this state in its address, when its first view is settled. */
  async open(state, { settled = true, ...options } = {}) {
    await this.page?.close();
    this.page = await this.browser.newPage({ viewport: { width: 1280, height: 800 }, ...options });
    this.page.setDefaultTimeout(PATIENCE);
    this.page.on("console", (message) => {
      if (message.type() === "error") this.errors.push(message.text());
    });
    this.page.on("pageerror", (error) => this.errors.push(String(error.stack)));
    await this.page.goto(`${this.address}#${state}`);
    if (settled) await this.settled();
    return this.page;
  }

  /** Waits until nothing more comes of a view. */
  settled(view = 0) {
    return this.page.waitForFunction((index) => window.shrouds?.session.views[index].settled, view);
  }

  /** Does something that makes another surface, or runs it, and waits for its end. */
  async resettled(doing, view = 0) {
    const before = await this.stamp(view);
    await doing();
    await this.page.waitForFunction(
      ([index, old]) => {
        const { settled, surface, iteration, state } = window.shrouds.session.views[index];
        return settled && JSON.stringify([surface?.revision, iteration, state]) !== old;
      },
      [view, before],
    );
  }

  stamp(view) {
    return this.page.evaluate((index) => {
      const { surface, iteration, state } = window.shrouds.session.views[index];
      return JSON.stringify([surface?.revision, iteration, state]);
    }, view);
  }

  /** What the page knows of a view. */
  view(index = 0) {
    return this.page.evaluate((number) => {
      const { surface, history, state, status, iteration, problem, numbers, sizes, way } =
        window.shrouds.session.views[number];
      return { surface, history, state, status, iteration, problem, numbers, sizes, way };
    }, index);
  }

  /** The numbers of a view, as soon as they are there. */
  async numbers(index = 0) {
    await this.page.waitForFunction((number) => window.shrouds.session.views[number].numbers, index);
    return (await this.view(index)).numbers;
  }

  /** The sizes of a view, as soon as all are there: nothing more goes on then. */
  async packed(index = 0) {
    await this.page.waitForFunction((number) => "8" in window.shrouds.session.views[number].sizes, index);
    return (await this.view(index)).sizes;
  }

  /** A place on the page well within the picture of the surface: the middle of its widest row. */
  async onSurface() {
    // Until the picture has come to rest.
    await this.page.waitForTimeout(1000);
    const { x, y } = await this.page.locator("#canvas").boundingBox();
    const [right, down] = await this.page.evaluate(() => {
      const { clientWidth, clientHeight } = document.getElementById("canvas");
      let [best, place] = [0, [0, 0]];
      for (let y = 20; y < clientHeight; y += 40) {
        let run = 0;
        for (let x = 10; x < clientWidth; x += 10) {
          run = window.shrouds.stage.hit(x, y) ? run + 1 : 0;
          if (run > best) [best, place] = [run, [x - 5 * run, y]];
        }
      }
      return place;
    });
    return [x + right, y + down];
  }

  /** How much of the picture differs from one before, as a share of its pixels. */
  async changed(doing) {
    const before = await this.pixels();
    await doing();
    await this.page.waitForTimeout(200);
    let share = 0;
    for (let attempt = 0; attempt < 25 && share < 1e-4; attempt++) {
      const after = await this.pixels();
      share = await this.page.evaluate(([a, b]) => window.compare(a, b), [before, after]);
      if (share < 1e-4) await this.page.waitForTimeout(200);
    }
    return share;
  }

  async pixels() {
    await this.page.evaluate(() => {
      window.compare ??= (a, b) => {
        let other = 0;
        for (let i = 0; i < a.length; i++) if (a[i] !== b[i]) other++;
        return other / a.length;
      };
    });
    return this.page.evaluate(async () => {
      const { stage } = window.shrouds;
      const image = await createImageBitmap(await stage.picture());
      const canvas = new OffscreenCanvas(image.width >> 1, image.height >> 1);
      const pen = canvas.getContext("2d");
      pen.drawImage(image, 0, 0, canvas.width, canvas.height);
      return Array.from(new Uint32Array(pen.getImageData(0, 0, canvas.width, canvas.height).data.buffer));
    });
  }
}
