// A picture of the live page of the real programs: node screenshot.mjs TO.png --page FOLDER --chromium PROGRAM --bin FOLDER
//
// fba-exact beside no law, the same hand on a dome through 50 ms +- 10 ms and 5 % loss each way; with --task instead a
// robot at that task, which is led down through the same network until it presses. Says how many frames a second were
// drawn meanwhile.
import { parseArgs } from "node:util";
import { needPage, openBrowser, Tab } from "./browser.mjs";
import { withPrograms } from "./programs.mjs";

const { values: given, positionals } = parseArgs({ allowPositionals: true, options: {
  page: { type: "string" }, chromium: { type: "string" }, bin: { type: "string" }, scene: { type: "string", default: "dome" },
  size: { type: "string", default: "1280x720" }, sharpness: { type: "string", default: "1" }, task: { type: "string" }, dark: { type: "boolean" }, alone: { type: "boolean" } } });
const [to] = positionals;
const kNetem = "delay 50ms 10ms loss 5%";

/** Drags the hand down onto the dome and along it, as a person would; the pointer stays down. */
async function stroke(tab) {
  const { x, y } = await tab.tip();
  await tab.page.mouse.move(x, y);
  await tab.page.mouse.down();
  const seen = (name) => tab.page.evaluate((value) =>
    Number(document.querySelector(`output[data-value="${value}"]`).textContent.replace("−", "-")), name);
  let down = 0;
  while (!(Math.abs(await seen("0.asked")) > 1) && down < 300) await tab.page.mouse.move(x, y + (down += 6), { steps: 3 });
  for (let turn = 0; turn < 60; ++turn) {
    await tab.page.mouse.move(x + 14 * Math.sin(turn / 6), y + down + 12, { steps: 2 });
    await tab.page.waitForTimeout(100);
  }
}

/** Takes the robot by the hand and leads it down until it presses, and a little further; the pointer stays down. */
async function press(tab) {
  await tab.until("it is told where the tool is", () => window.forcebound.stage.views[0].state.tool !== null);
  // The clutch, pressed and released.
  await tab.page.locator("#hold-button").hover();
  await tab.page.mouse.down();
  await tab.page.waitForTimeout(300);
  await tab.page.mouse.up();
  await tab.until("the robot follows", () => document.getElementById("robot").dataset.state === "following");
  const { x, y } = await tab.tip();
  await tab.page.mouse.move(x, y);
  await tab.page.mouse.down();
  const exerted_N = () => tab.page.evaluate(() => window.forcebound.stage.views[0].state.exerted.length());
  // Slowly, until it has pressed with 3 to 12 N for some frames.
  for (let down = 0, held = 0, tries = 0; held < 4 && tries < 60; ++tries) {
    const force_N = await exerted_N();
    down += force_N < 3 ? 5 : force_N > 12 ? -2 : 0;
    held = force_N >= 3 && force_N <= 12 ? held + 1 : 0;
    await tab.page.mouse.move(x, y + down);
    await tab.page.waitForTimeout(200);
  }
}

needPage(given.page);
const browser = await openBrowser(given.chromium);
try {
  await withPrograms(given.bin, async (programs) => {
    const what = given.task ? ["--device", "firm-3dof", "--operator", "pointer:stiffness_N_per_m=1500"] : ["--scene", given.scene, "--rendering", "remote"];
    const served = given.task ? ["--follower", "reach-7", "--task", given.task] : [];
    const client = await programs.client(kNetem, ["--law", "fba-exact", ...what], served);
    const size = given.size.split("x").map(Number);
    const tab = await Tab.open(browser, client.url, {
      size, colorScheme: given.dark ? "dark" : "light", deviceScaleFactor: Number(given.sharpness) });
    await tab.untilTicks();
    if (!given.alone && !given.task) {
      await tab.until("two laws run", () => document.querySelectorAll(".light").length === 2);
      await tab.untilValue("1.asked", "below", 1000);
    }
    if (given.alone) {
      await tab.page.locator("#law-beside").selectOption("no second law");
      await tab.until("one law runs", () => document.querySelectorAll(".light").length === 1);
    }
    await tab.page.waitForTimeout(2000);
    const frames = () => tab.page.evaluate(() => [window.forcebound.frames.count, performance.now()]);
    const [count, at] = await frames();
    await (given.task ? press(tab) : stroke(tab));
    const [more, later] = await frames();
    await tab.page.screenshot({ path: to });
    console.log(`${to}: ${(((more - count) * 1000) / (later - at)).toFixed(1)} frames a second, drawn without a graphics card`);
    await tab.close();
  });
} finally {
  await browser.close();
}
