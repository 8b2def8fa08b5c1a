// Puts the page together.

import { fromAddress, toAddress } from "./address.ts";
import { el } from "./dom.ts";
import { fillHelp, keyTable, listen } from "./keys.ts";
import { Looks } from "./looks.ts";
import { bar } from "./panels/bar.ts";
import { dataPanel, open, openFile, restore } from "./panels/data.ts";
import { editingPanel, sonarPanel } from "./panels/editing.ts";
import { fairingPanel } from "./panels/fairing.ts";
import { messages } from "./panels/messages.ts";
import { numbersPanel } from "./panels/numbers.ts";
import { outPanel } from "./panels/out.ts";
import { describe, layout, legend, makePanes } from "./panels/panes.ts";
import { PickedPanel } from "./panels/picked.ts";
import { seeingBar } from "./panels/seeing.ts";
import { triad } from "./panels/triad.ts";
import { pointer } from "./pointer.ts";
import { Stage } from "./scene/stage.ts";
import { Session } from "./session.ts";
import { Store, type State } from "./state.ts";

const part = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;

async function start(): Promise<void> {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const socket = new WebSocket(`${scheme}://${location.host}/ws${location.search}`);
  const store = new Store(fromAddress(location.hash));
  theme(store);
  const canvas = part<HTMLCanvasElement>("canvas");
  const panes = part("panes");
  makePanes(panes, store);
  notice("Connecting…");
  const session = await Session.start(socket, store);
  notice();
  // The program makes the first surface while the graphics card gets ready.
  const restored = restore(session);
  const stage = makeStage(canvas, store, panes);
  if (!stage) return socket.close();
  session.screen = stage;
  build(session, stage, canvas, panes);
  react(session, stage);
  remember(store);
  // For tests and for people with a console.
  Object.assign(window, { shrouds: { session, store, stage } });
  await restored;
}

function makeStage(canvas: HTMLCanvasElement, store: Store, panes: HTMLElement): Stage | undefined {
  try {
    const stage = new Stage(canvas, store, layout(panes));
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      notice("The graphics memory is short, or the graphics driver has stopped. Close other tabs, choose fewer views or a smaller volume, and reload the page: the address keeps your choices.");
    });
    canvas.addEventListener("webglcontextrestored", () => notice());
    return stage;
  } catch {
    notice("This browser cannot draw in three dimensions: it has no WebGL 2, or it is switched off. A current Firefox, Chromium or Safari can; the same surfaces come from `shrouds mesh` and `shrouds render`.");
    return undefined;
  }
}

function build(session: Session, stage: Stage, canvas: HTMLCanvasElement, panes: HTMLElement): void {
  const dialog = part<HTMLDialogElement>("help");
  const help = (): void => dialog.showModal();
  const keys = keyTable(session, stage, help);
  fillHelp(dialog, keys);
  listen(session, keys);
  messages(part("messages"), session);
  part("bar").append(...bar(session, help));
  const picked = new PickedPanel(session, stage);
  part("left").append(...dataPanel(session), editingPanel(session), sonarPanel(session, stage), outPanel(session, stage));
  part("right").append(...fairingPanel(session), picked.element);
  part("seeing").append(...seeingBar(session));
  part("numbers").append(...numbersPanel(session));
  describe(panes, session);
  let told = (): void => undefined;
  const key = legend(session, new Looks(session, stage, () => told()));
  told = key.show;
  part("stage").append(triad(stage), key.element);
  pointer(canvas, session, stage, (hit) => void picked.pick(hit));
  dropping(session);
}

/** What follows from choices. */
function react(session: Session, stage: Stage): void {
  const { store } = session;
  session.on("volumes", () => session.volume && stage.look(session.volume));
  let before = store.state;
  store.watch(["settings", "views"], (state: State) => {
    for (let view = 0; view < state.views; view++) {
      if (state.settings[view] !== before.settings[view] || view >= before.views) session.shroudSoon(view);
    }
    for (let view = state.views; view < before.views; view++) session.drop(view);
    before = state;
  });
  store.watch(["live"], ({ live, active }) => live && void session.control(active, "run"));
}

function dropping(session: Session): void {
  const over = (event: DragEvent): void => {
    event.preventDefault();
    document.body.classList.add("dropping");
  };
  document.addEventListener("dragover", over);
  document.addEventListener("dragleave", (event) => !event.relatedTarget && document.body.classList.remove("dropping"));
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("dropping");
    const file = event.dataTransfer?.files[0];
    const slot = event.shiftKey ? "b" : "a";
    if (file) void openFile(session, slot, file);
    else if (event.dataTransfer?.getData("text")) void open(session, slot, event.dataTransfer.getData("text").trim());
  });
}

function theme(store: Store): void {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const show = (): void => {
    const { theme: chosen } = store.state;
    document.documentElement.dataset.theme = chosen === "auto" ? (dark.matches ? "dark" : "light") : chosen;
  };
  dark.addEventListener("change", show);
  store.watch(["theme"], show);
  show();
}

/** The address follows the state; a pasted address is a new start. */
function remember(store: Store): void {
  let timer: ReturnType<typeof setTimeout>;
  let written = location.hash;
  store.watch([], () => {
    clearTimeout(timer);
    timer = setTimeout(() => {
      written = `#${toAddress(store.state)}`;
      history.replaceState(null, "", `${location.pathname}${location.search}${written}`);
    }, 200);
  });
  addEventListener("hashchange", () => location.hash !== written && location.reload());
}

function notice(text = ""): void {
  const box = part("notice");
  box.hidden = text === "";
  box.replaceChildren(el("div", {}, text));
}

void start();
