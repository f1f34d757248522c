// Chromium with the live page in it. Without the packages or the browser a test says SKIPPED and exits with 77.
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { existsSync } from "node:fs";
import { join, resolve } from "node:path";

export const kPatience_ms = 240_000; // a bound for what hangs; nothing is expected to take so long

export function skip(reason) {
  console.log(`SKIPPED: ${reason}`);
  process.exit(77);
}

/** Ends the test as skipped where the page was not bundled. */
export function needPage(folder) {
  if (!existsSync(join(folder, "index.html"))) skip(`there is no page in ${folder}: it takes node, npm and its registry to build`);
}

/** The npm packages of this folder: $FORCEBOUND_NODE_MODULES, or node_modules of the working directory. */
export function packages() {
  const places = [process.env.FORCEBOUND_NODE_MODULES, "node_modules"].filter(Boolean).map((place) => resolve(place));
  const found = places.find((place) => existsSync(join(place, "playwright-core")) && existsSync(join(place, "ws")));
  if (!found) skip("the npm packages playwright-core and ws are missing (npm ci with this folder's lock file)");
  return createRequire(join(found, "x"));
}

/**
 * Opens Chromium without a window or graphics card. SwiftShader draws the 3D view; the rest is drawn without OpenGL, as
 * browsers do on such a machine (drawing all of it with SwiftShader takes twenty times as long).
 */
export async function openBrowser(program, options = []) {
  if (!program || !existsSync(program)) skip("chromium is not installed (Debian: apt-get install chromium)");
  const { chromium } = packages()("playwright-core");
  const root = process.getuid?.() === 0 ? ["--no-sandbox"] : [];
  return chromium.launch({
    executablePath: program, args: ["--disable-gpu", "--enable-unsafe-swiftshader", ...root, ...options] });
}

/** Runs the case of that name in a browser, for a test that needs the page. */
export async function runCase(cases, name, { page, chromium }) {
  if (!cases[name]) {
    console.error(`unknown case '${name}', expected one of: ${Object.keys(cases).join(", ")}`);
    process.exit(2);
  }
  needPage(page);
  const browser = await openBrowser(chromium);
  try {
    await cases[name](browser);
    console.log(`passed: ${name}`);
  } finally {
    await browser.close();
  }
}

/** A page of its own, whose errors count: `faults` must be empty at the end. */
export class Tab {
  static async open(browser, url, { size = [1280, 720], ...settings } = {}) {
    const tab = new Tab();
    tab.faults = [];
    tab.context = await browser.newContext({ viewport: { width: size[0], height: size[1] }, ...settings });
    tab.page = await tab.context.newPage();
    tab.page.setDefaultTimeout(kPatience_ms);
    const host = new URL(url).host;
    tab.page.on("console", (message) => message.type() === "error" && tab.faults.push(message.text()));
    tab.page.on("pageerror", (error) => {
      console.error(error.stack); // now: what follows may wait in vain
      tab.faults.push(error.stack);
    });
    tab.page.on("requestfailed", (request) => tab.faults.push(`${request.url()} failed`));
    tab.page.on("request", (request) => {
      if (new URL(request.url()).host !== host) tab.faults.push(`${request.url()} is asked for elsewhere`);
    });
    await tab.page.goto(url);
    return tab;
  }

  /** Waits until a function in the page is true. */
  async until(what, inPage, argument) {
    try {
      await this.page.waitForFunction(inPage, argument, { timeout: kPatience_ms, polling: 100 });
    } catch (error) {
      throw new Error(`waited in vain until ${what} (${error.message.split("\n")[0]})`);
    }
  }

  text(id) {
    return this.page.locator(`#${id}`).innerText();
  }

  async untilConnected() {
    await this.until("the page is connected", () => document.body.dataset.link === "open" && document.body.dataset.program);
  }

  async untilTicks() {
    await this.untilConnected();
    await this.until("ticks are there", () => window.forcebound.charts.store && !window.forcebound.charts.store.empty);
  }

  /** Charts move: what is drawn now is drawn otherwise later. */
  async untilChartsMove() {
    await this.untilTicks();
    const picture = () => document.querySelector("#strips canvas").toDataURL();
    const before = await this.page.evaluate(picture);
    await this.until("the charts move", (old) => document.querySelector("#strips canvas").toDataURL() !== old, before);
  }

  /** Waits until a number under the charts, as people read it, fulfils a condition: "0.applied" above 1. */
  async untilValue(value, condition, bound) {
    await this.until(`${value} is ${condition} ${bound}`, ([name, how, limit]) => {
      const text = document.querySelector(`output[data-value="${name}"]`)?.textContent ?? "";
      const number = Number(text.replace("−", "-").replaceAll(",", ""));
      return text !== "–" && (how === "above" ? Math.abs(number) > limit : Math.abs(number) < limit);
    }, [value, condition, bound]);
  }

  /** Where the tip of a track is on the screen. */
  tip(track = 0) {
    return this.page.evaluate((index) => {
      const { stage } = window.forcebound;
      return stage.onScreen(index, stage.tip(index));
    }, track);
  }

  async light(track, passive) {
    await this.until(`track ${track}'s light says ${passive}`, ([index, wanted]) =>
      document.querySelector(`.light[data-track="${index}"]`)?.dataset.passive === wanted, [track, String(passive)]);
  }

  async close() {
    await this.context.close();
    assert.deepEqual(this.faults, [], "the page reported errors");
  }
}
