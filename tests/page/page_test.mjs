// The live page in a real browser: node page_test.mjs CASE --page FOLDER --chromium PROGRAM
//
// Nothing here expects an answer within a time: each step waits for what a person would wait for.
import assert from "node:assert/strict";
import { parseArgs } from "node:util";
import { needPage, openBrowser, packages, Tab } from "./browser.mjs";
import { StandIn } from "./stand_in.mjs";

const { values: given, positionals } = parseArgs({ allowPositionals: true, options: {
  page: { type: "string" }, chromium: { type: "string" } } });

const kSizes = { phone: [390, 844], desk: [1280, 720], wall: [1920, 1080] };

/** A stand-in for a program, for a case. */
async function withStandIn(options, then) {
  const stand = new StandIn({ packages: packages(), ...options });
  const url = await stand.listen(given.page);
  try {
    await then(stand, url);
  } finally {
    await stand.close();
  }
}

const cases = {
  /** Each size, light and dark: no error, nothing wider than the window, charts that move. */
  async looks(browser) {
    await withStandIn({}, async (stand, url) => {
      for (const [name, size] of Object.entries(kSizes)) {
        for (const colorScheme of ["light", "dark"]) {
          const tab = await Tab.open(browser, url, { size, colorScheme });
          await tab.untilChartsMove();
          const [wide, window_] = await tab.page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
          assert.ok(wide <= window_, `${name}: ${wide} pixels wide in a window of ${window_}`);
          for (const id of ["scene", "charts", "settings", "network", "latency", "events"]) {
            assert.ok(await tab.page.locator(`#${id}`).isVisible(), `${name}: '${id}' is not seen`);
          }
          await tab.close();
        }
      }
    });
  },

  /** Where there is no WebGL the page says so, and all but the 3D view works. */
  async no_webgl() {
    const browser = await openBrowser(given.chromium, ["--disable-3d-apis"]);
    await withStandIn({}, async (stand, url) => {
      const tab = await Tab.open(browser, url);
      await tab.untilChartsMove();
      assert.match(await tab.text("no-webgl"), /WebGL is missing/);
      await tab.page.locator("#view").focus();
      await tab.page.keyboard.press("ArrowRight");
      await tab.until("the hand moves", () => window.forcebound.stage.views[0].state.hand !== null);
      tab.faults = tab.faults.filter((fault) => !/WebGL/.test(fault)); // three.js says it too
      await tab.close();
    });
    await browser.close();
  },

  /** A program that goes away is missed, by the time of day, and found again. */
  async reconnect(browser) {
    await withStandIn({}, async (stand, url) => {
      const tab = await Tab.open(browser, url);
      await tab.untilChartsMove();
      const { port } = stand;
      await stand.close();
      await tab.page.locator("#lost").waitFor({ state: "visible" });
      assert.match(await tab.text("lost-text"), /lost.* at .*\d.*ago/);
      await stand.listen(given.page, port);
      await tab.page.locator("#lost").waitFor({ state: "hidden" });
      await tab.untilChartsMove();
      tab.faults = tab.faults.filter((fault) => !/WebSocket connection|live.* failed/.test(fault));
      await tab.close();
    });
  },

  /** Who has only a keyboard reaches everything, in the order in which it is seen, and is the hand. */
  async keyboard(browser) {
    await withStandIn({}, async (stand, url) => {
      const tab = await Tab.open(browser, url);
      await tab.untilChartsMove();
      const reached = [];
      for (let i = 0; i < 60 && !reached.includes("event-list"); ++i) {
        await tab.page.keyboard.press("Tab");
        reached.push(await tab.page.evaluate(() => document.activeElement.id));
      }
      const wanted = ["record", "law", "law-beside", "scene-name", "device", "stiffness", "delay_ms", "jitter_ms", "loss_percent",
        "view", "hold-button", "reset-view", "shorter", "longer", "pause", "strips", "event-list"];
      assert.deepEqual(reached.filter((id) => wanted.includes(id)), wanted);

      await tab.page.locator("#view").focus();
      await tab.page.keyboard.press("ArrowRight");
      await tab.until("the arrow key moves the hand", () => window.forcebound.stage.views[0].state.hand !== null);
      await tab.page.keyboard.press("Escape");
      await tab.until("Esc lets go", () => window.forcebound.stage.views[0].state.hand === null);

      await tab.page.locator("#strips").focus();
      await tab.page.keyboard.press(" ");
      assert.equal(await tab.text("pause"), "Go on");
      await tab.page.keyboard.press("+");
      assert.equal(await tab.text("window"), "5.00 s");
      await tab.page.keyboard.press("Home");
      assert.equal(await tab.text("pause"), "Pause");
      await tab.close();
    });
  },

  /** On a phone one finger is the hand, and two turn the scene. */
  async fingers(browser) {
    await withStandIn({}, async (stand, url) => {
      const tab = await Tab.open(browser, url, { size: kSizes.phone, hasTouch: true, isMobile: true });
      await tab.untilChartsMove();
      const touch = await tab.context.newCDPSession(tab.page);
      const fingers = (type, ...places) => touch.send("Input.dispatchTouchEvent",
        { type, touchPoints: places.map(({ x, y }, id) => ({ x, y, id })) });
      const { x, y } = await tab.tip();
      await fingers("touchStart", { x, y });
      await fingers("touchMove", { x: x + 40, y });
      await tab.until("the finger is the hand", () => window.forcebound.stage.views[0].state.hand !== null);
      await fingers("touchEnd");
      await tab.until("the finger lets go", () => window.forcebound.stage.views[0].state.hand === null);
      const angle = () => tab.page.evaluate(() => window.forcebound.stage.angles.azimuth);
      const before = await angle();
      await fingers("touchStart", { x: 100, y: 250 });
      await fingers("touchStart", { x: 100, y: 250 }, { x: 200, y: 250 });
      await fingers("touchMove", { x: 150, y: 250 }, { x: 250, y: 250 });
      await fingers("touchEnd");
      assert.notEqual(await angle(), before, "two fingers turn the scene");
      await tab.close();
    });
  },

  /** Who asked for less motion sees packets at rest. */
  async less_motion(browser) {
    await withStandIn({}, async (stand, url) => {
      stand.settings.network.loss_percent = 0;
      const picture = () => document.getElementById("pipe-up").toDataURL();
      const tab = await Tab.open(browser, url, { reducedMotion: "reduce" });
      await tab.untilChartsMove();
      await tab.page.locator("#pipes").waitFor();
      await tab.untilChartsMove();
      const before = await tab.page.evaluate(picture);
      for (let i = 0; i < 5; ++i) await tab.untilChartsMove();
      assert.equal(await tab.page.evaluate(picture), before);
      await tab.page.emulateMedia({ reducedMotion: "no-preference" });
      await tab.until("packets move", (old) => document.getElementById("pipe-up").toDataURL() !== old, before);
      await tab.close();
    });
  },

  /** The server's page: who is connected, and an end to it, asked for twice. */
  async sessions(browser) {
    await withStandIn({ program: "server" }, async (stand, url) => {
      for (const size of Object.values(kSizes)) {
        const tab = await Tab.open(browser, url, { size });
        await tab.untilConnected();
        await tab.page.getByText("anna").waitFor();
        assert.ok(await tab.page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), "too wide");
        assert.ok(await tab.page.locator("#settings").isHidden(), "a server has no law to choose");
        await tab.close();
      }
      const tab = await Tab.open(browser, url);
      const kick = tab.page.getByRole("button", { name: "End the session of bert" });
      await kick.click();
      assert.deepEqual(stand.heard.filter(({ kind }) => kind === "kick"), [], "one click only asks");
      await kick.click();
      await tab.page.getByText("bert").waitFor({ state: "detached" });
      assert.deepEqual(stand.heard.filter(({ kind }) => kind === "kick"), [{ kind: "kick", session: 2 }]);
      await tab.close();
    });
  },

  /** A recording's time is moved by its slider, by keyboard too. */
  async recording(browser) {
    await withStandIn({ program: "view" }, async (stand, url) => {
      const tab = await Tab.open(browser, url);
      await tab.untilChartsMove();
      await tab.page.locator("#time").focus();
      await tab.page.keyboard.press("End");
      await tab.page.locator("#speed").selectOption("0.1");
      await tab.page.locator("#play").click();
      while (stand.heard.length < 3) await tab.page.waitForTimeout(50);
      assert.deepEqual(stand.heard, [{ kind: "seek", time_s: 60 }, { kind: "play", on: true, speed: 0.1 },
        { kind: "play", on: false, speed: 0.1 }]);
      await tab.close();
    });
  },

  /** A device whose true energy nobody knows, and a request that is refused. */
  async unaudited(browser) {
    await withStandIn({ audited: false }, async (stand, url) => {
      const tab = await Tab.open(browser, url);
      await tab.light(0, null);
      await tab.until("the light says why", () => /Not audited/.test(document.querySelector(".light").textContent) &&
        /nobody audits/.test(document.querySelector(".light").textContent));
      const device = tab.page.locator("#device");
      const before = await device.inputValue();
      await device.selectOption("omni");
      await tab.page.locator("#toast").waitFor({ state: "visible" });
      assert.match(await tab.text("toast"), /'omni' is not plugged in/);
      assert.equal(await device.inputValue(), before, "what was refused is put back");
      await tab.close();
    });
  },
};

const [name] = positionals;
if (!cases[name]) {
  console.error(`page_test: unknown case '${name}', expected one of: ${Object.keys(cases).join(", ")}`);
  process.exit(2);
}
needPage(given.page);
const browser = await openBrowser(given.chromium);
try {
  await cases[name](browser);
  console.log(`passed: ${name}`);
} finally {
  await browser.close();
}
