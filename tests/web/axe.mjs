// The violations that axe finds on a page, by all of its rules or by `some`: each with its rule and place.
import { readFileSync } from "node:fs";

const axe = readFileSync(new URL("node_modules/axe-core/axe.min.js", import.meta.url), "utf8");

export async function axeViolations(page, some) {
  await page.evaluate(axe);
  const found = await page.evaluate((rules) =>
    window.axe.run(document, { resultTypes: ["violations"], ...(rules ? { runOnly: rules } : {}) }), some);
  return found.violations.flatMap(({ id, nodes }) => nodes.map(({ target, any }) => `${id}: ${target} ${any[0]?.message ?? ""}`));
}
