// All requests of the page to the service. Addresses are relative: the page may be served under any path.
import { text } from "../language/texts.js";

/** The catalogue, `{version, problems, schemes}`. It waits for `ready`, because a fault needs the texts of the page. */
export async function catalogue(ready) {
  const response = await fetch("v1/catalogue", { headers: { Accept: "application/json" } }).catch(() => null);
  await ready;
  if (!response?.ok) throw new Error(response ? text("answer.status", { status: String(response.status) }) : text("answer.silent"));
  return response.json();
}

/** Scenes as text to begin with: `[{name, title, note, problem, initial, scheme, until}]`, none where there are none. */
export async function scenes() {
  const response = await fetch("scenes.json").catch(() => null);
  return response?.ok ? response.json() : [];
}

const headers = (accept) => ({ "Content-Type": "application/json", Accept: accept });

/** Posts to `path`; resolves to the response, or to `{faults}` if there is none; rejects only when aborted. */
async function post(path, request, accept, signal) {
  try {
    return await fetch(path, { method: "POST", headers: headers(accept), body: JSON.stringify(request), signal });
  } catch (error) {
    if (signal.aborted) throw error;
    return lost("silent");
  }
}

/** The faults for an answer that did not come, or not completely. */
const lost = (name) => ({ faults: [{ detail: text(`answer.${name}`), lost: true }] });

/** The faults in a response that is no success. */
function refusal(response, answer) {
  if (answer?.errors?.length) return { faults: answer.errors };
  const wait = response.headers.get("Retry-After");
  const title = answer?.detail ?? answer?.title ?? text("answer.status", { status: String(response.status) });
  const id = answer?.request_id ? ` (${text("answer.request", { id: answer.request_id })})` : "";
  return { faults: [{ detail: title + id + (wait ? ` ${text("answer.wait", { wait })}` : "") }] };
}

/**
 * One request. Resolves to `{outcome}` when the service answered it (also when a run stopped early) and to
 * `{faults: [{pointer?, detail, allowed?}]}` when it did not; rejects only when aborted.
 */
async function ask(path, request, signal) {
  const response = await post(path, request, "application/json", signal);
  return response.faults ? response : whole(response, signal);
}

async function whole(response, signal) {
  let said;
  try {
    said = await response.text();
  } catch (error) {
    if (signal.aborted) throw error;
    return lost("silent");
  }
  const answer = parsed(said);
  return response.ok && answer ? { outcome: answer } : refusal(response, answer);
}

/** Like ask() for an answer in lines: calls `take(line)` for each as it comes, and resolves to `{}` at the end. */
async function askLines(path, request, signal, take) {
  const response = await post(path, request, "application/x-ndjson", signal);
  if (response.faults) return response;
  if (!response.headers.get("Content-Type")?.includes("ndjson")) return whole(response, signal);
  try {
    const reader = response.body.getReader(), decoder = new TextDecoder();
    let rest = "";
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return {};
      const lines = (rest + decoder.decode(value, { stream: true })).split("\n");
      rest = lines.pop();
      lines.map((line) => JSON.parse(line)).forEach(take);
    }
  } catch (error) {
    if (signal.aborted) throw error;
    return lost("broken");
  }
}

/** The card of a scene as text, for a start. */
export const describe = (problem, initial, signal) => ask("v1/problems", { problem, initial }, signal);
export const simulate = (request, signal) => ask("v1/simulate", request, signal);
export const stability = (request, signal) => ask("v1/stability", request, signal);
/** Studies of many runs, line by line. */
export const workPrecision = (request, signal, take) => askLines("v1/work-precision", request, signal, take);
export const periodic = (request, signal, take) => askLines("v1/periodic", request, signal, take);
export const ensemble = (request, signal, take) => askLines("v1/ensemble", request, signal, take);

/**
 * A run with its progress: `take(outcome)` is called whenever the service tells how far it is, with `status` "running", the time
 * `t` reached and the `trajectory` recorded so far.
 */
export async function follow(request, signal, take) {
  let outcome = null;
  const told = await askLines("v1/simulate", request, signal, ({ kind, ...line }) => {
    if (kind === "head") {
      outcome = { ...line, status: "running", trajectory: Object.fromEntries(line.columns.map((column) => [column.name ?? column, []])) };
    } else if (kind === "samples") {
      for (const [name, values] of Object.entries(line.trajectory)) for (const value of values) outcome.trajectory[name].push(value);
    } else {
      outcome = { ...outcome, ...line };
      if (kind === "progress") take(outcome);
    }
  });
  if (told.faults || told.outcome) return told;
  return outcome?.status === "running" || !outcome ? lost("broken") : { outcome };
}

function parsed(said) {
  try {
    return JSON.parse(said);
  } catch {
    return null;
  }
}
