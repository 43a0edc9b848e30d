// A request in forms that make the same run elsewhere: a command line, a program, or the request itself.

/** JSON for a string in single quotes in any of the languages: apostrophes are escaped, so that none ends the string. */
const quoted = (request) => JSON.stringify(request).replaceAll("'", "\\u0027");
const address = () => new URL("v1/simulate", document.baseURI);

export const programs = {
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
