// Which folder of the page may import which: folders lead from those that ask the service up to those that a reader sees, and
// no import leads back. Modules are short enough to be read at once.
import assert from "node:assert/strict";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { dirname, join, normalize } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const page = process.env.LEAST_PAGE ?? fileURLToPath(new URL("../../web/", import.meta.url));
/** Every folder with those below it that it may import; "." has what joins them. */
const base = ["language", "service", "forms"], seen = [...base, "catalogue", "drawing"];
const rooms = { language: [], service: ["language"], forms: ["language"], catalogue: base, drawing: base, own: base, studies: seen, lessons: seen,
                workbench: [...seen, "own", "studies"], ".": [...seen, "lessons", "workbench"] };

const modules = Object.keys(rooms).flatMap((room) => readdirSync(join(page, room)).filter((name) => name.endsWith(".js"))
  .map((name) => normalize(join(room, name)))).filter((file) => !file.startsWith("eslint"));
const importsOf = (file) => [...readFileSync(join(page, file), "utf8").matchAll(/^import (?:.* from )?"(.+)";$|\bimport\("(\.[^"]+)"\)/gm)]
  .map(([, path, later]) => path ?? later);

test("every folder of the page is a room", () => {
  const folders = readdirSync(page, { withFileTypes: true }).filter((entry) => entry.isDirectory() && entry.name !== "node_modules");
  assert.deepEqual(folders.map(({ name }) => name).sort(), Object.keys(rooms).filter((room) => room !== ".").sort());
  assert.deepEqual(modules.filter((file) => dirname(file) === "."), ["main.js"]);
});

test("a room uses those below it, and none in a circle", () => {
  for (const file of modules) {
    for (const path of importsOf(file)) {
      const used = normalize(join(dirname(file), path)), [here, there] = [dirname(file), dirname(used)];
      assert.ok(path.startsWith(".") && existsSync(join(page, used)), `${file} imports ${path}, which is no file of the page`);
      assert.ok(here === there || rooms[here].includes(there), `${file} imports ${used}: ${here} may use ${rooms[here].join(", ") || "no other"}`);
    }
  }
  const done = new Set();
  const walk = (file, way) => {
    assert.ok(!way.includes(file), `in a circle: ${[...way, file].join(" → ")}`);
    if (done.has(file)) return;
    for (const path of importsOf(file)) walk(normalize(join(dirname(file), path)), [...way, file]);
    done.add(file);
  };
  for (const file of modules) walk(file, []);
});

test("a module has at most 400 lines, and main.js leads to all of them", () => {
  for (const file of modules) assert.ok(readFileSync(join(page, file), "utf8").split("\n").length <= 400, file);
  const found = new Set(["main.js"]);
  for (const file of found) for (const path of importsOf(file)) found.add(normalize(join(dirname(file), path)));
  assert.deepEqual(modules.filter((file) => !found.has(file)), [], "used by nobody");
});
