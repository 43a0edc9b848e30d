# The damping of a pendulum from a CSV of t,a: Gauss-Newton with the derivatives of the service. fit_damping.py URL CSV
import csv, json, sys, urllib.request
t, a = zip(*[map(float, row) for row in csv.reader(open(sys.argv[2]))])
damping = 0.05
for _ in range(8):
    ask = {"problem": {"id": "custom", "variables": ["a"], "parameters": {"c": damping}, "potential": "-cos(a)", "damping": "c"},
           "initial": {"a": 2}, "scheme": "taylor", "until": t[-1] + 1e-9, "record": {"times": t}, "diagnostics": [],
           "sensitivities": {"by": ["/problem/c"], "at": "samples"}}
    made = json.load(urllib.request.urlopen(sys.argv[1] + "/v1/simulate", json.dumps(ask).encode()))
    slopes = [sample[made["sensitivities"]["rows"].index("a")][0] for sample in made["sensitivities"]["samples"]]
    damping += sum(s * (seen - x) for s, seen, x in zip(slopes, a, made["trajectory"]["a"])) / sum(s * s for s in slopes)
print(damping)
