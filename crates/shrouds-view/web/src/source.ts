// Where a volume comes from, as a text in the address and as the program wants it.

import type { Source } from "./protocol.ts";

/** `demo:NAME`, `demo:NAME:SIZE` or a path. */
export function sourceOf(text: string): Source {
  const demo = /^demo:(.+?)(?::(\d+))?$/.exec(text);
  if (!demo) return { path: text };
  const [, name = "", size] = demo;
  return size ? { demo: name, size: Number(size) } : { demo: name };
}

/** The text of a source; nothing for files that only this page has. */
export function sourceText(source: Source): string {
  if ("path" in source) return source.path;
  if ("upload" in source) return "";
  return `demo:${source.demo}${source.size ? `:${source.size}` : ""}`;
}
