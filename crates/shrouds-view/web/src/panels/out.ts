// What leaves the page: meshes, volumes, pictures, reports, the command line, the address.

import { button, el, field, row, section, select } from "../dom.ts";
import type { Stage } from "../scene/stage.ts";
import type { Session } from "../session.ts";

export function outPanel(session: Session, stage: Stage): HTMLElement {
  const format = select(session.hello.formats.map((value) => ({ value })), () => undefined);
  format.setAttribute("aria-label", "Format");
  format.dataset.out = "format";
  const frame = select([{ value: "world" }, { value: "index" }], () => undefined);
  const command = el("textarea", { rows: 3, readOnly: true, placeholder: "the equivalent command line" });
  command.setAttribute("aria-label", "The equivalent command line");
  const note = el("div", { className: "quiet" });
  const refresh = async (): Promise<void> => {
    const { index, surface } = session.active;
    if (!surface) return;
    const answer = await session.attempt(() => session.request<{ command: string; note: string | null }>("command", { view: index }));
    if (!answer) return;
    command.value = answer.command;
    note.textContent = answer.note ?? "";
  };
  session.on("settled", () => void refresh());
  session.store.watch(["active"], () => void refresh());
  return section(
    "Out",
    field("Mesh, volume", row(el("span", { className: "grow" }, format), button("Save", () => void save(session, format.value, frame.value)))),
    field("Coordinates", frame, "Those of the file, or voxel indices"),
    row(
      button("Picture", () => void picture(session, stage), "The picture as it is, as PNG"),
      button("Report", () => void report(session), "The report, as JSON"),
      button("Copy address", () => void copy(session, location.href, "The address"), "All choices are in the address"),
    ),
    command,
    note,
    row(button("Copy command", () => void copy(session, command.value, "The command line"))),
  );
}

async function save(session: Session, format: string, frame: string): Promise<void> {
  session.working("writing");
  const fields = { view: session.active.index, format, frame };
  const file = await session.attempt(() => session.request<{ download: string; name: string }>("export", fields));
  session.working();
  if (!file) return;
  download(`download/${encodeURIComponent(file.download)}${location.search}`, file.name);
}

async function picture(session: Session, stage: Stage): Promise<void> {
  const blob = await stage.picture();
  if (!blob) return session.say("error", "The browser could not make the picture.");
  offer(blob, `${baseName(session)}.png`);
}

async function report(session: Session): Promise<void> {
  const { index } = session.active;
  const answer = await session.attempt(() => session.request<{ report: unknown }>("report", { view: index }));
  if (!answer) return;
  offer(new Blob([JSON.stringify(answer.report, null, 2)], { type: "application/json" }), `${baseName(session)}.json`);
}

function baseName(session: Session): string {
  const name = session.volume?.name ?? "shroud";
  return name.replace(/^.*[\\/]/, "").replace(/\.[a-z.]+$/i, "").replaceAll(/[^\w-]+/g, "-") || "shroud";
}

function offer(blob: Blob, name: string): void {
  const address = URL.createObjectURL(blob);
  download(address, name);
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}

function download(href: string, name: string): void {
  const link = el("a", { href, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}

async function copy(session: Session, text: string, what: string): Promise<void> {
  await session.attempt(() => navigator.clipboard.writeText(text));
  session.say("info", `${what} is copied.`);
}
