// What the page says to the service, and nothing else. Addresses are relative: the page may be served under any path.

/** The catalogue: `{version, problems, schemes}`. */
export async function catalogue() {
  const response = await fetch("v1/catalogue", { headers: { Accept: "application/json" } });
  if (!response.ok) throw new Error(`the catalogue answers ${response.status}`);
  return response.json();
}

/**
 * One run. Resolves to `{outcome}` when the service ran it (also when the run stopped early) and to
 * `{faults: [{pointer?, detail, allowed?}]}` when it did not; rejects only when aborted.
 */
export async function simulate(request, signal) {
  let response, answer;
  try {
    response = await fetch("v1/simulate", {
      method: "POST",
      headers: { "Content-Type": "application/json", Accept: "application/json" },
      body: JSON.stringify(request),
      signal,
    });
    answer = parsed(await response.text());
  } catch (error) {
    if (signal.aborted) throw error;
    return { faults: [{ detail: "The service does not answer. Is it still running?" }] };
  }
  if (response.ok && answer) return { outcome: answer };
  if (answer?.errors?.length) return { faults: answer.errors };
  const wait = response.headers.get("Retry-After");
  const title = answer?.detail ?? answer?.title ?? `The service answers ${response.status}.`;
  const id = answer?.request_id ? ` (request ${answer.request_id})` : "";
  return { faults: [{ detail: title + id + (wait ? ` Try again in ${wait} s.` : "") }] };
}

function parsed(text) {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}

/** A command line that makes the same run. */
export function curl(request) {
  const quoted = JSON.stringify(request).replaceAll("'", "'\\''");
  return `curl -s ${new URL("v1/simulate", document.baseURI)} -d '${quoted}'`;
}
