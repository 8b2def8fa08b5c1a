// Energy, gradient and largest move against the steps, on log scales.

import { compact, el } from "../dom.ts";
import type { Session } from "../session.ts";
import type { Sample } from "../view.ts";

type Quantity = "energy" | "gradient" | "move" | "change";
interface Series {
  name: Quantity;
  text: string;
  colour: string;
  dash: number[];
}

const ENERGY: Series[] = [{ name: "energy", text: "energy", colour: "--energy", dash: [] }];
const MOVES: Series[] = [
  { name: "move", text: "move", colour: "--move", dash: [] },
  { name: "change", text: "change", colour: "--gradient", dash: [5, 3] },
  { name: "gradient", text: "gradient", colour: "--gradient", dash: [] },
];
const LEFT = 44;

export function plots(session: Session): HTMLElement[] {
  const parts = [ENERGY, MOVES].map((series) => plot(session, series));
  return parts.flat();
}

function plot(session: Session, series: Series[]): HTMLElement[] {
  const canvas = el("canvas", { className: "plot", role: "img" });
  const key = el("div", { className: "key" });
  const values = series.map(({ text, colour, name }) => {
    const value = el("b");
    const item = el("span", { title: helps[name] }, `${text} `, value);
    item.style.color = `var(${colour})`;
    key.append(item);
    return value;
  });
  let waiting = false;
  const show = (): void => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      const { history } = session.active;
      const last = history.at(-1);
      series.forEach(({ name }, i) => (values[i]!.textContent = compact(last?.[name])));
      canvas.setAttribute("aria-label", series.map(({ text, name }) => `${text} ${compact(last?.[name])}`).join(", "));
      drawPlot(canvas, history, series);
    });
  };
  for (const topic of ["solver", "views"] as const) session.on(topic, show);
  session.store.watch(["active", "theme"], show);
  new ResizeObserver(show).observe(canvas);
  return [key, canvas];
}

const helps: Record<Quantity, string> = {
  energy: "The sum that falls",
  gradient: "How much the energy still wants to fall within the bounds",
  move: "The longest way of a vertex in the last step, as a share of its grid edge",
  change: "What the stop rule looks at",
};

function drawPlot(canvas: HTMLCanvasElement, history: readonly Sample[], series: readonly Series[]): void {
  const ratio = devicePixelRatio;
  const { clientWidth: width, clientHeight: height } = canvas;
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  const pen = canvas.getContext("2d");
  if (!pen) return;
  const style = getComputedStyle(canvas);
  const colour = (name: string): string => style.getPropertyValue(name).trim();
  pen.scale(ratio, ratio);
  const points = series.map(({ name }) => pointsOf(history, name));
  const all = points.flat();
  const bottom = height - 6;
  pen.strokeStyle = colour("--line");
  pen.strokeRect(LEFT + 0.5, 4.5, width - LEFT - 1, bottom - 4);
  if (all.length === 0) return;
  const scale = logScale(all.map(([, value]) => value));
  const y = (value: number): number => bottom - 3 - (Math.log10(value) - scale.low) / (scale.high - scale.low) * (bottom - 11);
  const firstX = history[0]?.iteration ?? 0;
  const lastX = Math.max(history.at(-1)?.iteration ?? 1, firstX + 1);
  const x = (iteration: number): number => LEFT + 6 + ((iteration - firstX) / (lastX - firstX)) * (width - LEFT - 14);
  pen.font = `10px ${style.fontFamily}`;
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const tick of scale.ticks) {
    pen.fillStyle = colour("--quiet");
    pen.fillText(compact(Number(tick.toPrecision(3))), LEFT - 5, y(tick));
    pen.fillStyle = colour("--line");
    pen.fillRect(LEFT, y(tick), width - LEFT, 1);
  }
  series.forEach(({ colour: name, dash }, i) => curve(pen, points[i] ?? [], x, y, colour(name), dash));
}

function curve(
  pen: CanvasRenderingContext2D,
  points: readonly (readonly [number, number])[],
  x: (iteration: number) => number,
  y: (value: number) => number,
  colour: string,
  dash: number[],
): void {
  pen.strokeStyle = pen.fillStyle = colour;
  pen.lineWidth = 1.5;
  pen.setLineDash(dash);
  pen.beginPath();
  points.forEach(([iteration, value], i) => pen[i ? "lineTo" : "moveTo"](x(iteration), y(value)));
  pen.stroke();
  pen.setLineDash([]);
  if (points.length > 60) return;
  for (const [iteration, value] of points) {
    pen.beginPath();
    pen.arc(x(iteration), y(value), 2, 0, 7);
    pen.fill();
  }
}

/** On a log scale there is no place for zero. */
function pointsOf(history: readonly Sample[], name: Quantity): [number, number][] {
  return history.flatMap(({ iteration, [name]: value }) =>
    value !== null && value !== undefined && value > 0 ? [[iteration, value] as [number, number]] : [],
  );
}

/** Decades, or where all lies within one, the two ends. */
function logScale(values: readonly number[]): { low: number; high: number; ticks: number[] } {
  const logs = values.map(Math.log10);
  const low = logs.reduce((a, b) => Math.min(a, b), Infinity);
  const high = Math.max(logs.reduce((a, b) => Math.max(a, b), -Infinity), low + 0.004);
  const decades = [];
  for (let power = Math.ceil(low); power <= high; power++) decades.push(power);
  const every = Math.ceil(decades.length / 4);
  const ticks = decades.filter((_, i) => i % every === 0).map((power) => 10 ** power);
  return { low, high, ticks: ticks.length > 1 ? ticks : [10 ** low, 10 ** high] };
}
