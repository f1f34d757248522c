// What of the page needs no browser: node --test parts_test.mjs
import assert from "node:assert/strict";
import { test } from "node:test";
import { digits, duration, runTime, whole } from "../../client/page/src/text.js";
import { TickStore } from "../../client/page/src/tickstore.js";

const kPeriod_s = 0.001;

function filled(ticks, { span_s = 1, value = (i) => i, from = 0 } = {}) {
  const store = new TickStore(["a", "b"], kPeriod_s, span_s);
  for (let i = from; i < from + ticks; ++i) store.set(store.row(i * kPeriod_s), 0, value(i));
  return store;
}

test("a window of few ticks has each of them, at its time", () => {
  const store = filled(500);
  const [times, values] = store.window([0], 0.1, 0.2, 800, []);
  assert.equal(times[0], 0.1);
  assert.ok(times.at(-1) >= 0.2);
  values.forEach((value, i) => assert.equal(value, Math.round(times[i] / kPeriod_s)));
});

test("a long window is drawn from few rows, and loses no extreme", () => {
  const store = filled(60_000, { span_s: 65, value: (i) => (i === 31_234 ? 1000 : i === 7 ? -1000 : i % 10) });
  const [times, values] = store.window([0], 0, 60, 800, []);
  assert.ok(times.length < 1000, `${times.length} rows`);
  assert.equal(Math.max(...values), 1000);
  assert.equal(Math.min(...values), -1000);
  assert.ok(Math.abs(times[values.indexOf(1000)] - 31.234) < 0.13);
});

test("the oldest ticks go when the store is full, and the newest stay right", () => {
  const store = filled(10_500);
  assert.equal(store.newest_s, 10.499);
  assert.ok(store.newest_s - store.oldest_s <= 1);
  const [times, values] = store.window([0], 0, 20, 1e9, []);
  values.forEach((value, i) => assert.equal(value, Math.round(times[i] / kPeriod_s)));
});

test("what never came is not there", () => {
  const store = filled(10);
  store.set(store.row(0.02), 0, 20);
  const [times, values] = store.window([0], 0.008, 0.021, 800, []);
  assert.equal(times.length, 13);
  assert.ok([...values].slice(2, -1).every(Number.isNaN));
  assert.equal(store.at(0, 0.02), 20);
  assert.equal(store.at(0, 0.015), 9, "a value a little older");
  assert.ok(Number.isNaN(store.at(1, 0.02)), "a column without values");
});

test("a second track's ticks share the rows of the first", () => {
  const store = filled(100);
  store.set(store.row(0.0501), 1, 7);
  assert.equal(store.newest_s, 0.099);
  assert.equal(store.at(1, 0.05), 7);
});

test("time that goes back, or far ahead, begins the store anew", () => {
  const store = filled(5000);
  store.set(store.row(0.5), 0, 3);
  assert.equal(store.newest_s, 0.5);
  assert.equal(store.oldest_s, 0.5);
  store.set(store.row(100), 0, 4);
  assert.equal(store.oldest_s, 100);
});

test("numbers have three digits, thousands apart, and a sign that is a minus", () => {
  const texts = [[0, "0"], [1.23456, "1.23"], [-12.345, "−12.3"], [123.4, "123"], [-16633, "−16,630"], [0.0123456, "0.0123"], [0.00012345, "0.0001"],
    [1e-9, "0"], [-1e-9, "0"], [null, "–"], [NaN, "–"]];
  for (const [value, text] of texts) assert.equal(digits(value), text);
  assert.equal(whole(1234567), "1,234,567");
  assert.deepEqual([0, 59.94, 59.96, 185.2].map(runTime), ["0.0 s", "59.9 s", "1:00.0", "3:05.2"]);
  assert.deepEqual([8.9, 185, 7440].map(duration), ["8 s", "3 min 5 s", "2 h 4 min"]);
});
