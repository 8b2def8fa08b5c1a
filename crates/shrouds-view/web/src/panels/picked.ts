// The vertex that was picked: its grid edge, δ, neighbours, ρ.

import { compact, el, section } from "../dom.ts";
import type { Picked } from "../protocol.ts";
import type { Hit, Stage } from "../scene/stage.ts";
import type { Session } from "../session.ts";
import { axes } from "../state.ts";

export class PickedPanel {
  readonly element: HTMLDetailsElement;
  private readonly list = el("dl");
  private readonly hint = el("div", { className: "quiet" }, "Click on the surface to pick a vertex.");
  private last: { view: number; vertex: number; revision: number | undefined } | undefined;

  constructor(
    private readonly session: Session,
    private readonly stage: Stage,
  ) {
    this.element = section("Vertex", this.hint, this.list);
    session.on("started", () => this.mark(undefined));
    session.on("views", () => this.forget());
    session.on("settled", () => void this.ask());
  }

  async pick(hit: Hit): Promise<void> {
    if (this.session.views[hit.view]?.surface?.materials) {
      return this.session.say("info", "Vertices are picked on one body, not on the interfaces of several labels.");
    }
    const vertex = this.stage.vertex(hit);
    if (vertex < 0) return;
    this.last = { view: hit.view, vertex, revision: this.session.views[hit.view]?.surface?.revision };
    await this.ask();
  }

  private forget(): void {
    if (this.last && this.session.views[this.last.view]?.surface?.revision === this.last.revision) return;
    this.last = undefined;
    this.list.replaceChildren();
    this.hint.hidden = false;
    this.mark(undefined);
  }

  private async ask(): Promise<void> {
    const { last } = this;
    if (!last) return;
    const { view, vertex } = last;
    const picked = await this.session.attempt(() => this.session.request<Picked>("pick", { view, vertex }));
    if (!picked || this.last !== last) return;
    this.hint.hidden = true;
    const rows = facts(vertex, picked).flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]);
    this.list.replaceChildren(...rows);
    this.mark(picked, view);
  }

  /** The vertex as a disc, and the two curves through it. */
  private mark(picked: Picked | undefined, view = 0): void {
    const head = { view, revision: 0 };
    const point = picked && { kind: "points" as const, ...head, points: Float32Array.from(picked.position), inside: Float32Array.of(1) };
    this.stage.setOther("picked", point);
    if (!picked) return this.stage.setOther("picked-curves", undefined);
    const places = this.stage.positions(view);
    const ends = picked.neighbours.filter((vertex): vertex is number => vertex !== null);
    const points = ends.flatMap((vertex) => [...picked.position, ...(places?.subarray(3 * vertex, 3 * vertex + 3) ?? picked.position)]);
    const lengths = new Uint32Array(ends.length).fill(2);
    this.stage.setOther("picked-curves", { kind: "lines", ...head, lengths, points: Float32Array.from(points) });
  }
}

function facts(vertex: number, picked: Picked): [string, string][] {
  const { edge, delta, world, normal, neighbours, rho, curvature } = picked;
  const list = (values: readonly (number | null)[]): string => values.map((value) => compact(value && Number(value.toPrecision(4)))).join(", ");
  return [
    ["number", compact(vertex)],
    ["grid edge along", axes[edge.axis] ?? ""],
    ["inside", edge.inside.join(", ")],
    ["outside", edge.outside.join(", ")],
    ["δ", delta.toFixed(4)],
    ["position", list(world)],
    ["normal", list(normal)],
    ["neighbours", neighbours.map((other) => other ?? "none").join(", ")],
    ["ρ on its curves", list(rho)],
    ...Object.entries(curvature).map(([name, value]): [string, string] => [`${name} curvature`, compact(value)]),
  ];
}
