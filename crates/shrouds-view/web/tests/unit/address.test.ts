import assert from "node:assert/strict";
import { test } from "node:test";

import { fromAddress, toAddress } from "../../src/address.ts";
import { energyText, terms } from "../../src/energy.ts";
import { Store, initial, type State } from "../../src/state.ts";

test("what nobody touched needs no words", () => {
  assert.equal(toAddress(initial), "");
  assert.deepEqual(fromAddress(""), initial);
});

test("the state comes back from its address", () => {
  const state: State = {
    ...initial,
    source: "/data/a b&c=d#e%.nii.gz",
    labels: "3,17",
    hidden: "17",
    threshold: "0.5,",
    views: 3,
    active: 2,
    settings: [{ energy: "bending+0.3*variation" }, { start: "random:7", materials: "true" }, { smooth: "yes" }, {}],
    smooth: true,
    slice: "y",
    sliceAt: 0.25,
    live: false,
    camera: "1,-2.5,3,0,0,0,1",
  };
  assert.deepEqual(fromAddress(`#${toAddress(state)}`), state);
});

test("an address is readable", () => {
  const state = { ...initial, source: "demo:tori:32", clip: "z" as const, clipAt: 0.25 };
  assert.equal(toAddress(state), "source=demo:tori:32&clip=z&clip-at=0.25");
});

test("nonsense in an address changes nothing", () => {
  const text = "#views=99&active=7&every=NaN&clip=w&theme=pink&=&x&9.energy=a&__proto__=1&network=%";
  const read = fromAddress(text);
  assert.equal(read.views, 4);
  assert.equal(read.active, 3);
  assert.deepEqual([read.every, read.clip, read.theme, read.network], [4, "", "auto", false]);
  assert.deepEqual(read.settings[3], {});
});

test("energies are taken apart and put together", () => {
  for (const text of ["bending", "bending+0.3*variation", "2*tension(0.5,chord)+angle(cosine)"]) {
    assert.equal(energyText(terms(text) ?? []), text);
  }
  assert.deepEqual(terms("1e-3*length"), [{ weight: 0.001, measure: "length", arguments: "" }]);
  assert.equal(terms("bending+"), undefined);
  assert.equal(terms("3*"), undefined);
});

test("a store tells who asked of what changed", () => {
  const store = new Store(initial);
  const heard: string[] = [];
  store.watch(["smooth"], () => heard.push("smooth"));
  store.watch([], () => heard.push("any"));
  store.set({ smooth: false });
  store.set({ smooth: true });
  store.choose(1, "energy", "linear");
  store.choose(1, "energy", undefined);
  assert.deepEqual(heard, ["smooth", "any", "any", "any"]);
  assert.deepEqual(store.state.settings[1], {});
});
