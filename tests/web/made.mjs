// Scenes and schemes made up for a test, and answered here: what the tests of such shapes share.
import { readFileSync } from "node:fs";
import { all, catalogue, pageTest, settled } from "./browser.mjs";

/** A scene of core/scenes as a request has it, typed: `{problem, initial, until}`. */
export function typedScene(id) {
  const { title, scene: given, initial, until } = JSON.parse(readFileSync(new URL(`../../core/scenes/${id}.json`, import.meta.url)));
  return { problem: { id: "custom", title, ...given }, initial, until: { t: until } };
}

export const variable = (name, value, more = {}) => ({ name, symbol: name, doc: "", unit: "1", default: value, ...more });
export const scene = (id, more) => ({
  id, title: id, summary: "", formula: "<math><mi>H</mi></math>", parameters: [], until: { t: 50 }, suggested: { step: 0.1 },
  presets: [], invariants: [], columns: ["t", "energy"], diagnostics: ["energy"], schemes: ["leapfrog", "runge_kutta_4"],
  offers: "", references: [], ...more,
});

// x and y go round a circle; z is a quarter of that, and so is a quarter as high.
const motions = { t: (t) => t, q: Math.cos, p: (t) => -Math.sin(t), x: Math.cos, y: Math.sin, z: (t) => Math.sin(t) / 4,
                  mode: (t) => (t > 1 && t < 2 ? "jacobi_maupertuis" : "hamilton"), U: () => 0, energy: (t) => Math.exp(-t / 20) };
const measured = {
  energy: { initial: 1, final: 0.25, max_abs_error: 0.75, max_rel_error: 0.75, drift_per_time: -0.02 },
  decay: { max_residual: 0.00125 }, entropy: { initial: 0, final: 0.5, monotone: true },
  zeros: [1.5, 4.7, 7.9, 11, 14.1], cycle: { period: 6.66, amplitude: 2.01 },
};

/** A run of 501 samples, all of which `change` may alter. */
function answer(request, change) {
  const { initial: { t: start = 0 }, until, columns, diagnostics } = request;
  const times = Array.from({ length: 501 }, (_, i) => start + ((until.t - start) * i) / 500);
  const outcome = {
    status: "completed", scheme: request.scheme,
    trajectory: Object.fromEntries(columns.map((column) => [column, times.map(motions[column])])),
    diagnostics: Object.fromEntries(diagnostics.map((kind) => [kind, measured[kind]])), warnings: [],
    cost: { steps: 500, force_evaluations: 500, iterations: 0, seconds: 1e-3, nanoseconds_per_step: 2000 },
  };
  change?.(outcome, request);
  return outcome;
}

/**
 * A test among made-up `problems`, with made-up `schemes` beside those that there are; `asked` holds the requests so far,
 * those of A before those of B, `change(outcome, request)` may alter what is answered, and `more(context)` answer more.
 */
export const madeUp = (problems, schemes = []) => (name, { change, more, hash = `#problem=${problems[0].id}`, ...context }, body) => {
  const asked = [];
  const prepare = async (opened) => {
    await opened.route("**/v1/catalogue", (route) =>
      route.fulfill({ json: { ...catalogue, problems, schemes: [...schemes, ...catalogue.schemes] } }));
    await opened.route("**/v1/simulate", (route) => {
      const request = route.request().postDataJSON();
      asked.push(request);
      return route.fulfill({ json: answer(request, change) });
    });
    await more?.(opened);
  };
  pageTest(name, { prepare, hash, ...context }, (page, opened) => body(page, asked, opened));
};

export const fieldAt = (page, pointer) => page.locator(`[data-pointer='${pointer}']`);

export async function enter(page, pointer, value) {
  await fieldAt(page, pointer).fill(value);
  await fieldAt(page, pointer).press("Enter");
  await settled(page);
}

export const row = (page, id) => all(page, `#numbers tr[data-row="${id}"] td`, "textContent");
