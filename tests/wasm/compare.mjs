// Calibrates the readings of a folder with the module, and compares with what the native program printed there.
import { readFileSync } from "node:fs";

const [module, folder] = process.argv.slice(2);
const { instance } = await WebAssembly.instantiate(readFileSync(module), {});
const { memory, readings, calibrate } = instance.exports;
const rows = readFileSync(`${folder}/inter_prism.csv`, "utf8").trim().split("\n").slice(1);
const distances = readFileSync(`${folder}/calibration_results.csv`, "utf8").trim().split(/\s+/).slice(0, 3).map(Number);
const address = readings(rows.length);
const values = new Float64Array(memory.buffer, address, 5 * rows.length);
rows.forEach((row, index) => {
  const [time, station, range, azimuth, zenith] = row.split(",").map(Number);
  values.set([station, time, range, azimuth, zenith], 5 * index);
});
// The memory grows while it calibrates, which detaches the buffer that was read before.
const read = (address) => new Float64Array(memory.buffer, address, 8);
let largest = 0;
for (const [joint, method] of [[0, "inter-prism"], [1, "joint"]]) {
  const answer = Array.from(read(calibrate(joint, ...distances)));
  const native = JSON.parse(readFileSync(`${folder}/${method}.json`, "utf8"));
  const expected = native.transforms.flatMap((t) => [...t.translation_m, t.yaw_rad]);
  const difference = Math.max(...answer.map((value, index) => Math.abs(value - expected[index])));
  console.log(`${method}: largest difference from the native program ${difference.toExponential(1)} m or rad`);
  largest = Math.max(largest, Number.isNaN(difference) ? Infinity : difference);
}
// Both are the same arithmetic; sines and the order of sums of several threads differ in the last digits.
if (!(largest < 1e-9)) {
  console.error(`WebAssembly and native differ by ${largest}`);
  process.exit(1);
}
