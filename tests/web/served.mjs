// The program and a browser, for whoever looks at the page.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { accessSync, constants } from "node:fs";
import { delimiter, join } from "node:path";
import { createInterface } from "node:readline";
import { chromium } from "playwright-core";

export const browserPath = process.env.LEAST_BROWSER || onPath("chromium", "chromium-headless-shell", "google-chrome", "google-chrome-stable", "chrome");
const switches = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
                  "--disable-component-update", "--disable-sync"];

/** `{origin, browser, stop()}`: where LEAST_BINARY serves, with `more` options, and the browser, with `switched` on. */
export async function start(switched = [], more = []) {
  assert.ok(process.env.LEAST_BINARY, "LEAST_BINARY must name the program");
  const service = spawn(process.env.LEAST_BINARY, ["serve", "--port", "0", ...more], { stdio: ["ignore", "pipe", "ignore"] });
  const origin = await new Promise((resolve, reject) => {
    createInterface({ input: service.stdout }).on("line", (line) => {
      const found = /listening on (http:\/\/\S+?)\/?$/.exec(line);
      if (found) resolve(found[1]);
    });
    service.on("error", reject);
    service.on("exit", (code) => reject(new Error(`the service ended with ${code} before it listened`)));
  });
  const browser = await chromium.launch({ executablePath: browserPath, args: [...switches, ...switched] });
  return { origin, browser, async stop() {
    await browser.close();
    service.removeAllListeners("exit");
    service.kill("SIGTERM");
  } };
}

function onPath(...names) {
  for (const name of names) {
    for (const folder of (process.env.PATH ?? "").split(delimiter)) {
      try {
        accessSync(join(folder, name), constants.X_OK);
        return join(folder, name);
      } catch {
        // not here
      }
    }
  }
  return null;
}
