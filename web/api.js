// What the page says to the service, and nothing else. Addresses are relative: the page may be served under any path.

/** The catalogue: `{version, problems, schemes}`. */
export async function catalogue() {
  const response = await fetch("v1/catalogue", { headers: { Accept: "application/json" } });
  if (!response.ok) throw new Error(`the catalogue answers ${response.status}`);
  return response.json();
}

/** Scenes as text to begin with: `[{name, title, note, problem, initial, scheme, until}]`, none where there are none. */
export async function scenes() {
  const response = await fetch("scenes.json").catch(() => null);
  return response?.ok ? response.json() : [];
}

const headers = (accept) => ({ "Content-Type": "application/json", Accept: accept });

/** Asks under `path` and resolves to the response, or to what is wrong; rejects only when aborted. */
async function post(path, request, accept, signal) {
  try {
    return await fetch(path, { method: "POST", headers: headers(accept), body: JSON.stringify(request), signal });
  } catch (error) {
    if (signal.aborted) throw error;
    return silent;
  }
}

const silent = { faults: [{ detail: "The service does not answer. Is it still running?", lost: true }] };

/** What a response says that is no success. */
function refusal(response, answer) {
  if (answer?.errors?.length) return { faults: answer.errors };
  const wait = response.headers.get("Retry-After");
  const title = answer?.detail ?? answer?.title ?? `The service answers ${response.status}.`;
  const id = answer?.request_id ? ` (request ${answer.request_id})` : "";
  return { faults: [{ detail: title + id + (wait ? ` Try again in ${wait} s.` : "") }] };
}

/**
 * One request. Resolves to `{outcome}` when the service answered it (also when a run stopped early) and to
 * `{faults: [{pointer?, detail, allowed?}]}` when it did not; rejects only when aborted.
 */
async function ask(path, request, signal) {
  const response = await post(path, request, "application/json", signal);
  if (response.faults) return response;
  let text;
  try {
    text = await response.text();
  } catch (error) {
    if (signal.aborted) throw error;
    return silent;
  }
  const answer = parsed(text);
  return response.ok && answer ? { outcome: answer } : refusal(response, answer);
}

/** The card of a scene as text. */
export const describe = (problem, signal) => ask("v1/problems", { problem }, signal);
export const simulate = (request, signal) => ask("v1/simulate", request, signal);
export const stability = (request, signal) => ask("v1/stability", request, signal);

/**
 * A study whose lines go to `take(line)` as they come. Resolves to `{}` at its end, else to `{faults}`; rejects only when
 * aborted.
 */
export async function workPrecision(request, signal, take) {
  const response = await post("v1/work-precision", request, "application/x-ndjson", signal);
  if (response.faults) return response;
  try {
    if (!response.ok) return refusal(response, parsed(await response.text()));
    const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
    let rest = "";
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return {};
      const lines = (rest + value).split("\n");
      rest = lines.pop();
      lines.map((line) => JSON.parse(line)).forEach(take);
    }
  } catch (error) {
    if (signal.aborted) throw error;
    return { faults: [{ detail: "The study broke off. Is the service still running?" }] };
  }
}

function parsed(text) {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}
