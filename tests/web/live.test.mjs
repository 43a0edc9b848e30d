// Requests that follow a hand, without a page: one at a time, the newest next, and an error of one holds up none.
import assert from "node:assert/strict";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const { Live } = await import(process.env.LEAST_PAGE ? `${process.env.LEAST_PAGE}/service/live.js` : fileURLToPath(new URL("../../web/service/live.js", import.meta.url)));

/** A Live whose answers come when the test says so: `answers.get(question)` is `{resolve, reject, signal}`. */
function made(show = () => {}) {
  const answers = new Map(), shown = [];
  const live = new Live((question, signal) => new Promise((resolve, reject) => answers.set(question, { resolve, reject, signal })), (answer, question) => {
    shown.push([question, answer]);
    show(question);
  });
  return { live, answers, shown };
}
const soon = () => new Promise((done) => setImmediate(done));
/** What is thrown where nobody catches it while `act` runs. */
async function thrown(act) {
  const seen = [], note = (error) => seen.push(error.message), before = process.listeners("unhandledRejection");
  process.removeAllListeners("unhandledRejection");
  process.on("unhandledRejection", note);
  await act();
  await soon();
  process.off("unhandledRejection", note);
  before.forEach((one) => process.on("unhandledRejection", one));
  return seen;
}

test("only the newest of the questions that came meanwhile is asked next", async () => {
  const { live, answers, shown } = made();
  for (const question of ["a", "b", "c"]) live.ask(question);
  assert.deepEqual([...answers.keys()], ["a"]);
  answers.get("a").resolve(1);
  await soon();
  assert.deepEqual([[...answers.keys()], shown], [["a", "c"], [["a", 1]]]);
  answers.get("c").resolve(2);
  await soon();
  assert.deepEqual(shown, [["a", 1], ["c", 2]]);
});

test("an urgent question drops the one in flight, also while an answer is shown", async () => {
  const { live, answers, shown } = made((question) => question === "b" && live.ask("c", true));
  live.ask("a");
  live.ask("b", true);
  assert.ok(answers.get("a").signal.aborted);
  answers.get("a").reject(new Error("aborted"));
  answers.get("b").resolve(2);
  await soon();
  answers.get("c").resolve(3);
  await soon();
  assert.deepEqual(shown, [["b", 2], ["c", 3]]);
});

test("an error that is no abort is thrown, and the next question is asked", async () => {
  const { live, answers, shown } = made((question) => {
    if (question === "c") throw new Error("of a picture");
  });
  live.ask("a");
  live.ask("b");
  assert.deepEqual(await thrown(() => answers.get("a").reject(new Error("of a request"))), ["of a request"]);
  assert.ok(answers.has("b"), "which waited");
  answers.get("b").resolve(2);
  await soon();
  live.ask("c");
  assert.deepEqual(await thrown(() => answers.get("c").resolve(3)), ["of a picture"]);
  live.ask("d");
  answers.get("d")?.resolve(4);
  await soon();
  assert.deepEqual(shown, [["b", 2], ["c", 3], ["d", 4]]);
});
