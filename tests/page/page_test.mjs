// The live page in a real browser: node page_test.mjs CASE --page FOLDER --chromium PROGRAM
//
// Nothing here expects an answer within a time: each step waits for what a person would wait for.
import assert from "node:assert/strict";
import { parseArgs } from "node:util";
import { openBrowser, packages, runCase, Tab } from "./browser.mjs";
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

  /** On a sharp screen the numbers along an axis are as large as on another: uPlot takes whole pixels alone. */
  async sharp(browser) {
    await withStandIn({}, async (stand, url) => {
      for (const deviceScaleFactor of [1, 2]) {
        for (const size of Object.values(kSizes)) {
          const tab = await Tab.open(browser, url, { size, deviceScaleFactor });
          await tab.untilChartsMove();
          const [wanted, sizes] = await tab.page.evaluate(() => {
            const text = parseFloat(getComputedStyle(document.documentElement).fontSize);
            const drawn = window.forcebound.charts.charts.flatMap(({ plot }) => plot.axes.map(({ font }) => parseFloat(font[0])));
            return [Math.round(0.72 * text), drawn.map((pixels) => pixels / window.devicePixelRatio)];
          });
          assert.equal(sizes.length, 10);
          for (const pixels of sizes) assert.equal(pixels, wanted, `${deviceScaleFactor} pixels of the screen for one of the page`);
          await tab.close();
        }
      }
    });
  },

  /** What was not touched is not judged; once it is, a sentence says what the verdict means. */
  async untouched(browser) {
    await withStandIn({ still: true }, async (stand, url) => {
      const tab = await Tab.open(browser, url);
      const says = (verdict, meaning) => tab.until(`the light says ${verdict}`, ([wanted, sentence]) =>
        document.querySelector(".verdict")?.textContent === wanted && document.querySelector(".means").textContent.includes(sentence),
      [verdict, meaning]);
      await says("Not touched yet", "No force was asked for");
      stand.still = false;
      await says("Passive", "The device has given your hand no energy.");
      stand.tracks[0].least = -0.0123;
      await says("Not passive", "up to 12.3 mJ more than its damping took");
      await tab.close();
    });
  },

  /** "?" explains a term beside it, and goes away with Esc; what it covers stays within the window. */
  async help(browser) {
    await withStandIn({}, async (stand, url) => {
      for (const size of Object.values(kSizes)) {
        const tab = await Tab.open(browser, url, { size });
        await tab.untilChartsMove();
        for (const [term, answer] of [["P, the true energy balance", /0 or above/], ["The ledger", /may spend now/],
          ["The place the force is for", /where the tip was/], ["Where the time goes", /medians, each off by less than 0\.05 %/]]) {
          await tab.page.getByRole("button", { name: `What is this: ${term}?` }).first().click();
          await tab.page.locator("#help").waitFor({ state: "visible" });
          assert.equal(await tab.text("help-title"), term);
          assert.match(await tab.text("help-text"), answer);
          const box = await tab.page.locator("#help").boundingBox();
          assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= size[0] && box.y + box.height <= size[1], JSON.stringify(box));
          await tab.page.keyboard.press("Escape");
          await tab.page.locator("#help").waitFor({ state: "hidden" });
        }
        await tab.close();
      }
    });
  },

  /** Where the time goes are the program's medians, not read from bins. */
  async medians(browser) {
    await withStandIn({}, async (stand, url) => {
      const tab = await Tab.open(browser, url);
      await tab.until("the medians are told", () => document.getElementById("histogram-text").textContent ===
        "Network: median 40.2 ms, 99 % below 80.4 ms. Server: median 0.0300 ms, 99 % below 0.0600 ms. " +
        "Waiting: median 0.600 ms, 99 % below 1.20 ms. Total: median 40.9 ms, 99 % below 81.8 ms.");
      await tab.close();
    });
  },

  /** A handle that turns is drawn with its tool and its torque; the tip is the tool's. */
  async turned(browser) {
    const half = Math.SQRT1_2;
    await withStandIn({ still: true, tool_m: [0, 0, -0.02], turned: { orientation: [half, half, 0, 0], torque_N_m: [0, 0, 0.03] } },
      async (stand, url) => {
        const tab = await Tab.open(browser, url);
        await tab.untilChartsMove();
        await tab.until("the handle is drawn", () => window.forcebound.stage.views[0].marks.handle.visible);
        const seen = await tab.page.evaluate(() => {
          const { marks, state } = window.forcebound.stage.views[0];
          return { tip: marks.tip.position.clone().sub(state.tip).toArray(), rod: marks.rod.visible, torque: marks.torque.visible };
        });
        // A quarter turn about x takes -z to y.
        for (const [i, wanted] of [0, 0.02, 0].entries()) assert.ok(Math.abs(seen.tip[i] - wanted) < 1e-6, JSON.stringify(seen));
        assert.ok(seen.rod && seen.torque, JSON.stringify(seen));
        await tab.until("the torque has its number", () => /0\.0300 N m; full circle: 0\.05 N m/.test(document.getElementById("legend-torque").textContent));
        stand.turned = null;
        await tab.until("another device has neither", () => !window.forcebound.stage.views[0].marks.handle.visible &&
          !window.forcebound.stage.views[0].marks.torque.visible && document.getElementById("legend-torque").hidden);
        await tab.close();
      });
  },

  /** A robot's panel tells how to engage with the device that leads it, and of what nobody knows it has no row. */
  async engage(browser) {
    const values = (state, clutch) => ({ values: { state, leader_has_clutch: clutch, tool_x_m: 0.5, tool_y_m: 0, tool_z_m: 0.1,
      force_x_N: 0, force_y_N: 0, force_z_N: -3, lag_m: 0.001, drift_m: 0, store_J: 0.1, received_J: 0 } });
    for (const program of ["client", "server"]) {
      await withStandIn({ program, robot: { name: "reach-7", solids: 0 }, moved: values(1, 1) }, async (stand, url) => {
        const tab = await Tab.open(browser, url);
        for (const [state, clutch, hint] of [[1, 1, "press and release the clutch, and it follows"],
          [1, 0, "keep the device still for a moment, and it follows"], [1, -1, "nobody leads it"],
          [6, 0, "it is at rest: move the device, and keep it still for a moment, and it follows again"]]) {
          stand.moved = values(state, clutch);
          await tab.until(`the hint is '${hint}'`, (wanted) => document.getElementById("robot-hint").textContent === wanted, hint);
        }
        const rows = await tab.page.locator("#robot-numbers div:visible dd").allInnerTexts();
        assert.ok(rows.length >= 4 && !rows.includes("–"), rows.join("; "));
        if (program === "client") assert.equal(await tab.text("hold-button"), "Clutch");
        await tab.close();
      });
    }
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
        const cells = await tab.page.locator("#session-rows tr:first-child td:visible").allInnerTexts();
        assert.ok(cells.length > 5 && !cells.some((text) => ["", "–"].includes(text.trim())), `an empty column: ${cells.join("|")}`);
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
    await withStandIn({ program: "view", recording: "/a/folder/run.mcap" }, async (stand, url) => {
      const tab = await Tab.open(browser, url);
      await tab.untilChartsMove();
      assert.equal(await tab.text("record-file"), "run.mcap");
      assert.equal(await tab.page.locator("#record-file").getAttribute("title"), "/a/folder/run.mcap");
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
        /Nobody audits/.test(document.querySelector(".light").textContent));
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

await runCase(cases, positionals[0], given);
