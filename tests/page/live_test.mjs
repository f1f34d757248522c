// The live page of the real programs in a real browser: node live_test.mjs CASE --page FOLDER --chromium PROGRAM --bin FOLDER
//
//     server <-- relay, 50 ms each way unless a case says otherwise <-- client --page <-- browser
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { join } from "node:path";
import { parseArgs } from "node:util";
import { runCase, Tab } from "./browser.mjs";
import { withPrograms } from "./programs.mjs";

const { values: given, positionals } = parseArgs({ allowPositionals: true, options: {
  page: { type: "string" }, chromium: { type: "string" }, bin: { type: "string" } } });

const kFar = "delay 50ms";
const kWall = ["--scene", "wall", "--device", "wall-1dof", "--rendering", "remote"];

/** Takes hold of a track's tip with the pointer and pulls it sideways [pixels]; the pointer stays down. */
async function pull(tab, right, down = 0) {
  const { x, y } = await tab.tip();
  await tab.page.mouse.move(x, y);
  await tab.page.mouse.down();
  await tab.page.mouse.move(x + right, y + down, { steps: 15 });
}

/** Waits until so much more of the run has gone by [s of the device's time]. */
async function forSeconds(tab, seconds) {
  const from = await tab.page.evaluate(() => window.forcebound.charts.store.newest_s);
  await tab.until(`${seconds} s went by`, (until) => window.forcebound.charts.store.newest_s >= until, from + seconds);
}

/** The clutch, pressed and released: from then on the robot follows. */
async function engage(tab) {
  const follows = () => tab.page.evaluate(() => document.getElementById("robot").dataset.state === "following");
  // Again where the machine gave a program no time just then, and the robot waits for another press.
  for (let press = 0; press < 20 && !(await follows()); ++press) {
    await tab.page.locator("#hold-button").hover();
    await tab.page.mouse.down();
    await forSeconds(tab, 0.3);
    await tab.page.mouse.up();
    for (let waits = 0; waits < 10 && !(await follows()); ++waits) await forSeconds(tab, 0.3);
  }
  assert.ok(await follows(), "the robot follows");
}

/** Waits for the run of another choice: the light of a law with its name. */
async function untilLaw(tab, track, law) {
  await tab.until(`track ${track} runs ${law}`, ([index, name]) =>
    document.querySelector(`.light[data-track="${index}"] .law-name`)?.textContent === name, [track, law]);
}

async function withClient(browser, options, then, netem = kFar, served = []) {
  await withPrograms(given.bin, async (programs) => {
    const client = await programs.client(netem, options, served);
    const tab = await Tab.open(browser, client.url);
    await tab.untilTicks();
    await then(tab, programs, client);
    await tab.close();
  });
}

const cases = {
  /** The pointer moves the hand, the wall answers, and a hand that lets go has no force any more. */
  async hand(browser) {
    await withClient(browser, [...kWall, "--law", "fba-exact"], async (tab) => {
      await tab.untilChartsMove();
      const before = await tab.tip();
      await pull(tab, 250);
      await tab.untilValue("0.asked", "above", 0.5);
      await tab.untilValue("0.applied", "above", 0.1);
      assert.ok((await tab.tip()).x > before.x, "the tip follows the pointer");
      await tab.page.mouse.move(before.x - 150, before.y, { steps: 15 });
      await tab.untilValue("0.asked", "below", 0.01);
      await tab.page.mouse.up();
    });
  },

  /** Without a law a wall through 50 ms is not passive, and the light says so; fba-exact from the same page is. */
  async passivity(browser) {
    await withClient(browser, [...kWall, "--law", "none"], async (tab) => {
      await pull(tab, 250);
      await tab.light(0, false);
      await tab.page.mouse.up();
      await tab.page.locator("#law").selectOption("fba-exact");
      await untilLaw(tab, 0, "fba-exact");
      await tab.light(0, true);
      await pull(tab, 250);
      await tab.untilValue("0.asked", "above", 0.5);
      await forSeconds(tab, 3);
      await tab.light(0, true);
      await tab.page.mouse.up();
    });
  },

  /** Two laws side by side, with one hand. */
  async beside(browser) {
    await withClient(browser, [...kWall, "--law", "fba-exact"], async (tab) => {
      await untilLaw(tab, 1, "none"); // from the start
      await tab.untilValue("1.x", "above", 0);
      await pull(tab, 150);
      await tab.light(1, false);
      await tab.light(0, true);
      await tab.page.mouse.up();
      await tab.page.locator("#law-beside").selectOption("no second law");
      await tab.until("one track is left", () => document.querySelectorAll(".light").length === 1);
    });
  },

  /** The sliders change the relay: forces come at another age. */
  async network(browser) {
    await withClient(browser, [...kWall], async (tab) => {
      await tab.untilValue("0.age", "above", 90);
      await tab.page.getByRole("button", { name: "Same room" }).click();
      await tab.untilValue("0.age", "below", 40);
      assert.equal(await tab.text("delay_ms-value"), "0 ms");
      await tab.page.locator("#delay_ms").focus();
      await tab.page.keyboard.press("End");
      await tab.untilValue("0.age", "above", 350);
    });
  },

  /** Another scene is a new session, and is drawn. */
  async scene(browser) {
    await withClient(browser, ["--scene", "sphere", "--device", "cartesian-3dof"], async (tab) => {
      const drawn = (count) => tab.until("the scene is drawn", (least) => window.forcebound.stage.views[0].parts.children.length >= least, count);
      await drawn(1);
      await tab.page.locator("#scene-name").selectOption("box");
      await tab.until("the scene is another", () => document.getElementById("scene-title").textContent.startsWith("scene: box"));
      await drawn(1);
      await tab.untilChartsMove();
      await tab.page.locator("#scene-name").selectOption({ label: "the server's default" });
      await tab.until("the scene is the server's", () => document.getElementById("scene-title").textContent.startsWith("scene: cylinder"));
      await tab.untilChartsMove();
    }, kFar, ["--scene", "cylinder"]);
  },

  /** The scene is drawn with remote rendering as well, where the client need not know it. */
  async remote(browser) {
    await withClient(browser, ["--scene", "dome", "--rendering", "remote"], async (tab) => {
      await tab.until("the scene is drawn", () => window.forcebound.stage.views[0].parts.children.length === 1);
      assert.match(await tab.text("scene-title"), /^scene: dome/);
    });
  },

  /** The tip begins outside of a scene that the client is not told the name of; its handle is drawn where it turns. */
  async begin(browser) {
    await withClient(browser, ["--device", "arm-6dof"], async (tab) => {
      await tab.until("the tip is where the scene's hand begins", () => {
        const { tip, turn } = window.forcebound.stage.views[0].state;
        return turn !== null && Math.abs(tip.length() - 0.04) < 2e-3;
      });
      await tab.until("nothing was touched", () => document.querySelector(".verdict").textContent === "Not touched yet");
      assert.ok(await tab.page.evaluate(() => window.forcebound.stage.views[0].marks.handle.visible));
    }, kFar, ["--scene", "sphere"]);
  },

  /** Tissue is drawn as the server tells, and gives way under the hand. */
  async moved(browser) {
    await withClient(browser, ["--scene", "pad"], async (tab) => {
      const lowest = () => tab.page.evaluate(() => {
        const vertices = window.forcebound.stage.views[0].parts.getObjectByName("pad")?.children[0].geometry.getAttribute("position").array;
        return vertices ? [...vertices].filter((_, i) => i % 3 === 2).sort((a, b) => b - a).slice(0, 40).at(-1) : null;
      });
      await tab.until("the pad is drawn and told of", () =>
        window.forcebound.stage.views[0].parts.getObjectByName("pad")?.children.length === 2);
      const before = await lowest();
      await pull(tab, 0, 160);
      await tab.untilValue("0.asked", "above", 0.3);
      await tab.until("the pad gives way", (top) => {
        const { array } = window.forcebound.stage.views[0].parts.getObjectByName("pad").children[0].geometry.getAttribute("position");
        return [...array].filter((_, i) => i % 3 === 2).sort((a, b) => b - a)[39] < top - 1e-4;
      }, before);
      await tab.page.mouse.up();
    }, "delay 5ms");
  },

  /** A block that is pushed moves on the page, where nobody knows where it is but the server. */
  async bodies(browser) {
    await withClient(browser, ["--scene", "block_and_stop"], async (tab) => {
      const places = () => window.forcebound.stage.views[0].parts.children
        .filter((part) => !part.userData.endless).map((part) => part.position.toArray()).flat();
      await tab.until("bodies are drawn", () => window.forcebound.stage.views[0].parts.children.length >= 2);
      const before = await tab.page.evaluate(places);
      await pull(tab, 200, 120);
      await tab.until("a body moves", (old) => window.forcebound.stage.views[0].parts.children
        .filter((part) => !part.userData.endless).map((part) => part.position.toArray()).flat()
        .some((value, i) => Math.abs(value - old[i]) > 1e-3), before);
      await tab.page.mouse.up();
    }, "delay 5ms");
  },

  /** A robot that follows is drawn with its task; it moves with the hand, both forces and its numbers are shown. */
  async robot(browser) {
    await withClient(browser, ["--device", "firm-3dof"], async (tab) => {
      await tab.until("arm and plate are drawn", () => window.forcebound.stage.views[0].parts.children.length > 15 &&
        window.forcebound.stage.views[0].parts.children.some((part) => part.name.startsWith("forearm")) &&
        window.forcebound.stage.views[0].parts.children.some((part) => part.name === "wall"));
      await tab.until("it is told where the tool is", () => window.forcebound.stage.views[0].state.tool !== null);
      assert.match(await tab.text("robot-hint"), /^press and release the clutch, and it follows$/);
      assert.equal(await tab.text("hold-button"), "Clutch");
      assert.equal(await tab.page.locator(".light").count(), 1, "one hand leads it");
      await engage(tab);
      const { x, y } = await tab.tip();
      await tab.page.mouse.move(x, y);
      await tab.page.mouse.down();
      const height = () => tab.page.evaluate(() => window.forcebound.stage.views[0].state.tool.z);
      const before = await height();
      // Gently: a robot that hits the wall at its largest speed is stopped by its contact limit.
      // Further than needed, as what the hand moves while its loop has no time is not followed.
      const presses = () => tab.page.evaluate(() => window.forcebound.stage.views[0].state.exerted.length() > 1.5);
      for (let pixels = 5; pixels <= 400 && !(await presses()); pixels += 5) {
        await tab.page.mouse.move(x, y + pixels);
        await forSeconds(tab, 0.03);
      }
      await tab.until("it presses", () => window.forcebound.stage.views[0].state.exerted.length() > 1.5);
      assert.ok(await height() < before - 0.02, "the arm went down with the hand");
      await tab.until("both forces have their newtons", () => ["applied", "exerted"].every((name) =>
        / N$/.test(document.querySelector(`.force-label.colour-${name}:not([hidden])`)?.textContent ?? "")));
      assert.match(await tab.text("robot-numbers"), /position-force.*×\s1/s);
      assert.equal(await tab.page.locator("#scene-name option:checked").textContent(), "the server's default");
      assert.ok(await tab.page.locator("#legend-exerted").isVisible());
      await tab.light(0, true);
      await tab.page.mouse.up();
    }, "delay 20ms", ["--follower", "reach-7", "--task", "stiff-wall"]);
  },

  /** A recording replays; its slider seeks, by the keyboard too. */
  async replay(browser) {
    await withPrograms(given.bin, async (programs) => {
      const server = await programs.server();
      const client = programs.start("client", ["--server", server.address, ...kWall, "--duration", "6", "--record", "run.mcap", "--quiet"]);
      await client.ended;
      const view = await programs.withPage("view", ["run.mcap"]);
      const tab = await Tab.open(browser, view.url);
      await tab.untilChartsMove();
      await tab.until("the scene is drawn", () => window.forcebound.stage.views[0].parts.children.length === 1);
      await tab.page.locator("#play").click();
      await tab.until("it has stopped", () => document.getElementById("play").textContent === "Play");
      const slider = tab.page.locator("#time");
      const newest = (from, to) => tab.until(`the newest tick is from ${from} to ${to} s`, ([least, most]) => {
        const { newest_s } = window.forcebound.charts.store;
        return newest_s >= least && newest_s <= most;
      }, [from, to]);
      await slider.fill("4");
      await newest(3.5, 4.01); // the last before 4 s
      await slider.fill("1.5");
      await newest(1, 1.51);
      await slider.focus();
      await tab.page.keyboard.press("End");
      await newest(5.5, 6.1);
      assert.match(await tab.text("time-text"), / of /);
      await tab.close();
    });
  },

  /** A recording is begun and ended, and is there as a file. */
  async recorded(browser) {
    await withClient(browser, [...kWall], async (tab, programs) => {
      await tab.page.locator("#record").click();
      await tab.until("it is recorded", () => document.getElementById("record").getAttribute("aria-pressed") === "true");
      const file = join(programs.folder, (await tab.page.locator("#record-file").textContent()).split("/").at(-1));
      await tab.untilTicks();
      await forSeconds(tab, 2);
      await tab.page.locator("#record").click();
      await tab.until("the recording has ended", () => document.getElementById("record").getAttribute("aria-pressed") === "false");
      assert.ok(statSync(file).size > 10_000, `${file} has some seconds of ticks`);
    });
  },

  /** The server's page lists the session, and ends it. */
  async server(browser) {
    await withPrograms(given.bin, async (programs) => {
      const server = await programs.withPage("server", ["--listen", "127.0.0.1:0"]);
      const address = await server.says(/listening on (127\.0\.0\.1:\d+)/);
      programs.start("client", ["--server", address, ...kWall, "--quiet"]);
      const tab = await Tab.open(browser, server.url);
      await tab.page.locator("#session-rows tr").waitFor();
      assert.match(await tab.text("session-rows"), /wall/);
      await tab.page.locator(".event", { hasText: "connected to scene 'wall' with device 'wall-1dof'" }).waitFor();
      const first = await tab.page.locator("#session-rows tr").getAttribute("data-session");
      const kick = tab.page.locator(`#session-rows tr[data-session="${first}"] .kick`);
      // The first click only asks, and what it asked lapses after 3 s.
      for (let clicks = 0; clicks < 20 && (await kick.count()) > 0; ++clicks) {
        await kick.click({ timeout: 5000 }).catch(() => {}); // it may have ended meanwhile
        await tab.page.waitForTimeout(300);
      }
      await tab.until("that session has ended", (id) => !document.querySelector(`#session-rows tr[data-session="${id}"]`), first);
      await tab.page.locator(".event", { hasText: "is disconnected, as asked for on the page" }).waitFor();
      await tab.close();
    });
  },
};

await runCase(cases, positionals[0], given);
