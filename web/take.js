// To take away: a request as a command line, a program or itself; a trajectory as a table; a picture.

/** JSON that a text between quotes of any program may hold: no text of a reader's ends it. */
const quoted = (request) => JSON.stringify(request).replaceAll("'", "\\u0027");
const address = () => new URL("v1/simulate", document.baseURI);

/** What makes the same run elsewhere. */
export const forms = {
  curl: (request) => `curl -s ${address()} -d '${quoted(request)}'`,
  JSON: (request) => JSON.stringify(request, null, 1),
  Python: (request) => `import json, urllib.error, urllib.request
import numpy

request = json.loads(r'''${quoted(request)}''')
try:
    answer = json.load(urllib.request.urlopen("${address()}", json.dumps(request).encode()))
except urllib.error.HTTPError as refusal:
    faults = json.load(refusal).get("errors", [])
    raise SystemExit("\\n".join(f"{f['pointer']}: {f['detail']}" for f in faults) or str(refusal))
columns = {name: numpy.array(values) for name, values in answer["trajectory"].items()}
print(answer["status"], answer["cost"]["force_evaluations"], "force evaluations")
`,
};

/** The trajectories of runs `[{name, trajectory}]` as a table: a line for each sample, the run first. */
export function csvOf(runs) {
  const columns = [...new Set(runs.flatMap(({ trajectory }) => Object.keys(trajectory)))];
  const lines = runs.flatMap(({ name, trajectory }) => trajectory.t.map((_, i) =>
    [name, ...columns.map((column) => trajectory[column]?.[i] ?? "")].join(",")));
  return [["run", ...columns].join(","), ...lines].join("\n") + "\n";
}

/** Offers a file to the reader. */
export function download(name, blob) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A canvas as a picture on the page's ground. */
export function pngOf(canvas) {
  const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
  const pen = copy.getContext("2d");
  pen.fillStyle = getComputedStyle(canvas).getPropertyValue("--paper");
  pen.fillRect(0, 0, copy.width, copy.height);
  pen.drawImage(canvas, 0, 0);
  return new Promise((resolve) => copy.toBlob(resolve, "image/png"));
}
