// What the lessons say, as conditions on the data that the page shows.
import assert from "node:assert/strict";

const end = (values) => values.findLast((v) => v !== null);
const largest = (values) => Math.max(...values.map(Math.abs));
const falls = (values) => values.every((v, i) => i === 0 || v <= values[i - 1] + 1e-6);
const share = (values, wanted) => values.filter(wanted).length / values.length;

/** What each lesson says, as a condition on its runs (of a study: on its curves). */
export const claims = {
  orbit([good, bad]) {
    assert.ok(Math.abs(good.cost.force_evaluations / bad.cost.force_evaluations - 1) < 0.01, "equal work");
    assert.ok(Math.abs(good.diagnostics.orbit.semi_major_axis - 1) < 0.01 && bad.diagnostics.orbit.semi_major_axis < 0.8);
    assert.ok(largest(good.trajectory.energy.map((e) => e + 0.5)) < 0.002 && end(bad.trajectory.energy) < -0.6);
  },
  spiral([euler, midpoint, leapfrog]) {
    assert.ok(largest(euler.trajectory.q) > 1000 && end(midpoint.trajectory.energy) > 0.7);
    assert.ok(largest(leapfrog.trajectory.q) < 1.05);
  },
  pendulum([good, bad]) {
    const late = ({ trajectory: { q } }) => largest(q.slice(-400));
    assert.ok(Math.abs(good.cost.force_evaluations / bad.cost.force_evaluations - 1) < 0.01, "equal work");
    assert.ok(late(good) > 1.95 && late(bad) < 0.5);
  },
  portrait([little, far, over, back, between, own]) {
    const turns = ({ trajectory: { q } }) => largest(q) > Math.PI, returns = ({ trajectory: { q } }) => q.some((v, i) => i > 0 && v * q[i - 1] < 0);
    assert.ok([little, far, own].every((run) => !turns(run) && returns(run)) && turns(over) && turns(back));
    assert.ok(end(over.trajectory.q) > 4 * Math.PI && end(back.trajectory.q) < -4 * Math.PI);
    const { q, p } = between.trajectory;
    assert.ok(!turns(between) && end(q) > 3.14 && p.every((v, i) => Math.abs(v - 2 * Math.cos(q[i] / 2)) < 2e-3), "on the separatrix");
  },
  paper(runs) {
    const [long, short, hybrid, timed] = runs.map(({ diagnostics }) => Math.abs(diagnostics.orbit.apsidal_rotation));
    assert.ok(Math.abs(long / 0.0454 - 1) < 0.02 && Math.abs(long / short - 4) < 0.3 && hybrid < 1e-4 && timed < 1e-10);
    assert.ok(runs[2].trajectory.mode.includes("jacobi_maupertuis"));
  },
  clock(runs) {
    const mean = (a, b) => (Math.abs(a - b) < 1e-15 ? a : mean((a + b) / 2, Math.sqrt(a * b)));
    const period = (a) => (2 * Math.PI * Math.sqrt(0.994 / 9.81)) / mean(1, Math.cos(a / 2)), h = 1e-5;
    const slopes = runs.map(({ initial: { q }, events: [{ t }], sensitivities: { events: [{ t: [byA, byL] }] } }) => {
      assert.ok(Math.abs(t - period(q)) < 1e-9, `T(${q}) is ${t}`);
      assert.ok(Math.abs(byA - (period(q + h) - period(q - h)) / (2 * h)) < 1e-7, `dT/dA at ${q} is ${byA}`);
      assert.ok(Math.abs(byL / (t / 0.994) - 0.5) < 1e-9, "a longer pendulum is slower at every swing alike");
      return byA;
    });
    assert.ok(slopes[0] < 0.03 && slopes[4] > 0.8);
    const minutes = ((slopes[4] / period(2)) * 86400 * (Math.PI / 180)) / 60;
    assert.ok(minutes > 7.5 && minutes < 8.5, `for a degree more, a day: ${minutes}`);
  },
  frame([lift, rungeKutta]) {
    const drifts = ({ trajectory: { energy } }) => energy.map((e) => Math.abs(e / energy[0] - 1)), radius = ({ trajectory: { r } }) => r.at(-1);
    assert.ok(Math.max(...drifts(lift)) < 6e-4 && drifts(rungeKutta).at(-1) > 0.1, `${Math.max(...drifts(lift))}, ${drifts(rungeKutta).at(-1)}`);
    assert.ok(Math.abs(radius(lift) - 0.312) < 0.02 && radius(rungeKutta) < 0.26, `${radius(lift)}, ${radius(rungeKutta)}`);
    const { t, energy } = rungeKutta.trajectory, pace = (from, to) => (energy[to] - energy[from]) / (t[to] - t[from]), n = energy.length - 1, third = Math.floor(n / 3);
    assert.ok(pace(0, third) < 0 && pace(n - third, n) < 3 * pace(0, third), "one way, and faster the lower it is");
    assert.ok(rungeKutta.cost.force_evaluations > 3.9 * lift.cost.force_evaluations);
  },
  arenstorf([once, near, other, orbit]) {
    const { initial, final, sensitivities } = once, names = ["x", "y", "px", "py"], matrix = sensitivities.final;
    assert.ok(names.every((name) => Math.abs(final[name] - initial[name]) < 1e-9), "it closes");
    const half = matrix.reduce((sum, row, i) => sum + row[i], -2) / 2, growth = half + Math.sqrt(half * half - 1);
    assert.ok(Math.abs(growth - 285.4037) < 1e-3, `${growth}`);
    const way = names.map((name) => (near.initial[name] - orbit.initial[name]) / 1e-7), size = Math.max(...way.map(Math.abs));
    matrix.forEach((row, i) => assert.ok(Math.abs(row.reduce((sum, v, k) => sum + v * way[k], 0) - growth * way[i]) < 1e-4 * growth * size, "along the fastest way"));
    const apart = (run, base, k) => Math.hypot(...["x", "y"].map((name) => run.trajectory[name][2000 * k] - base.trajectory[name][2000 * k]));
    for (const run of [near, other]) {
      const [first, second] = [1, 2].map((k) => apart(run, orbit, k) / apart(run, orbit, k - 1));
      assert.ok(Math.abs(first / growth - 1) < 0.01 && Math.abs(second / growth - 1) < 0.12, `each round ${first}, ${second}`);
      assert.ok(apart(run, orbit, 3) > 0.3, "in the third they leave");
    }
    assert.ok(apart(near, other, 3) > 0.3, "to both sides");
    assert.ok(Math.hypot(orbit.final.x - 0.994, orbit.final.y) < 1e-6, "the orbit itself is still there");
  },
  planets([good, bad]) {
    assert.ok(Math.abs(good.cost.force_evaluations / bad.cost.force_evaluations - 1) < 0.01, "equal work");
    const off = ({ trajectory: { energy } }) => energy.map((e) => Math.abs(e / energy[0] - 1)), late = (values) => largest(values.slice(-400));
    assert.ok(largest(off(good)) < 2e-3 && late(off(good)) < 1.1 * largest(off(good).slice(0, 400)), "it swings and stays");
    assert.ok(late(off(bad)) > 0.1, `it drifts: ${late(off(bad))}`);
    const jupiter = ({ trajectory: t }) => t["x[2]"].map((x, i) => Math.hypot(x - t["x[1]"][i], t["y[2]"][i] - t["y[1]"][i]));
    assert.ok(largest(jupiter(good)) < 5.5 && end(jupiter(bad)) > 100, "Jupiter stays, or is thrown out");
    assert.ok(jupiter(bad)[300] < 0.95 * jupiter(bad)[0] || Math.min(...jupiter(bad)) < 2, "having come nearer to the sun");
  },
  chain([run]) {
    const { mode1, mode2, mode3, t } = run.trajectory, first = mode1[0], back = mode1.slice(t.findIndex((v) => v > 9000));
    assert.ok(Math.min(...mode1) < 0.1 * first && largest(mode2) > 0.8 * first && largest(mode3) > 0.6 * first, "the others have it");
    assert.ok(largest(back) > 0.95 * first, `${largest(back) / first} comes back`);
    assert.ok(run.diagnostics.energy === undefined && Math.abs(first - 0.0747) < 1e-3);
  },
  backward([there, back, other, astray]) {
    const height = ({ trajectory }) => trajectory.height, grows = (values) => values.at(-1) > 10 * values[0];
    assert.ok([back, astray].every(({ trajectory: { t } }) => t[0] === 48 && t.at(-1) === 0), "backward");
    assert.ok(grows(height(back)) && grows(height(there).toReversed()), "friction gives its energy back");
    assert.ok(Math.hypot(back.final.q - 2.5, back.final.p) < 1e-11, `${back.final.q}`);
    assert.ok(Math.abs(astray.final.q - 2.5) > 1 && Math.abs(other.cost.force_evaluations / there.cost.force_evaluations - 1) < 0.01);
  },
  bounce(runs) {
    const rests = [0.5, 0.7, 0.8].map((e) => (Math.SQRT2 * (1 + e)) / (1 - e));
    for (const [i, { status, stop }] of runs.entries()) {
      assert.ok(status === "stopped" && stop.reason === "accumulating_events" && Math.abs(stop.singular_at / rests[i] - 1) < 1e-7, `${stop?.singular_at}`);
    }
    assert.ok(Math.abs(rests[2] - 9 * Math.SQRT2) < 1e-12, "as it is said");
    assert.ok(runs.every(({ trajectory: { x }, acts }) => Math.min(...x) > -1e-9 && acts[0].count > 20), "above the floor");
  },
  damped([contact, other]) {
    const off = ({ trajectory: { mechanical_energy: e } }) => end(e) / (0.5 * Math.exp(-0.1 * 300));
    assert.ok(Math.abs(off(contact) - 1) < 0.2 && off(other) < 0.01, `${off(contact)}, ${off(other)}`);
  },
  driven: (runs) => assert.ok(Math.max(...runs.map(({ final: { q } }) => q)) - Math.min(...runs.map(({ final: { q } }) => q)) < 0.02),
  orders(runs) {
    const truth = runs[3].final, [second, fourth, sixth] = runs.map(({ final: { x, y } }) => Math.hypot(x - truth.x, y - truth.y));
    assert.ok(second > 50 * fourth && fourth > 50 * sixth, `${second}, ${fourth}, ${sixth}`);
  },
  stars(runs) {
    const [flat, sine, plummer, own] = runs.map(({ diagnostics }) => diagnostics.zeros[0]);
    assert.ok(Math.abs(flat - Math.sqrt(6)) < 1e-3 && Math.abs(sine - Math.PI) < 1e-3 && plummer === undefined && own > sine);
    const { t, q } = runs[2].trajectory;
    assert.ok(largest(t.map((r, i) => q[i] - 1 / Math.sqrt(1 + (r * r) / 3))) < 1e-4, "the formula");
  },
  relaxation(runs) {
    const [one, ten, hundred, thousand] = runs.map(({ diagnostics }) => diagnostics.cycle);
    assert.ok([one, ten, hundred, thousand].every(({ amplitude }) => Math.abs(amplitude - 2) < 0.02));
    assert.ok(one.period < 7 && ten.period < 20 && Math.abs(thousand.period / hundred.period / 10 - 1) < 0.02);
  },
  capture(runs) {
    assert.deepEqual(runs.map(({ trajectory: { p } }) => Math.sign(p[0] - 1)), [1, 1, -1], "two are fast, one is slow");
    assert.ok(runs.every(({ trajectory: { p } }) => Math.abs(p.slice(-1000).reduce((a, b) => a + b) / 1000 - 1) < 0.02));
  },
  cosmos([first, second, euler]) {
    const off = ({ trajectory: { q, p, s } }) => largest(q.map((_, i) => Math.hypot(q[i], p[i], s[i]) - Math.SQRT2));
    assert.ok(off(first) < 1e-3 && off(second) < 1e-3 && off(euler) > 0.05);
    assert.ok(first.trajectory.s[0] < -1.2 && Math.abs(first.final.s - Math.SQRT2) < 1e-3, "from pole to pole");
  },
  bath([narrow, wide]) {
    const inner = ({ trajectory: { q } }) => share(q, (v) => Math.abs(v) < 0.6745); // of a Gaussian 0.5
    const far = ({ trajectory: { q } }) => share(q, (v) => Math.abs(v) > 2.3); // of a Gaussian 0.021
    assert.ok(Math.abs(inner(narrow) - 0.5) < 0.02 && Math.abs(far(narrow) - 0.021) < 0.006, `${inner(narrow)} ${far(narrow)}`);
    assert.equal(far(wide), 0);
  },
  downhill(runs) {
    assert.ok(runs.every(({ trajectory: { potential } }) => falls(potential)));
    assert.deepEqual([...new Set(runs.map(({ final: { x } }) => Math.sign(x)))].sort(), [-1, 1], "both wells");
  },
  heat([splitting, euler]) {
    assert.ok(largest(splitting.trajectory.energy.map((e) => e - 1.5)) < 1e-12 && end(euler.trajectory.energy) > 10);
    assert.ok(splitting.diagnostics.entropy.monotone && splitting.diagnostics.entropy.final > 0.3);
  },
  butterfly([a, b]) {
    const apart = a.trajectory.x.map((x, i) => Math.abs(x - b.trajectory.x[i])), part = Math.floor(apart.length / 5);
    assert.ok(largest(apart.slice(0, part)) < 1e-2 && largest(apart.slice(-2 * part)) > 10);
  },
  islands(points) {
    const found = widths(points), sways = found.filter((width) => width < Math.PI).length;
    assert.ok(found.length === 40 && sways >= 5 && sways <= 15 && found.filter((width) => width > 5.4).length === 40 - sways, `${found}`);
  },
  galaxy({ member, x, y }) {
    const visited = Array.from({ length: 20 }, (_, m) => new Set(member.flatMap((of, i) => (
      of === m ? [`${Math.floor(x[i] * 50)},${Math.floor(y[i] * 50)}`] : []))).size);
    assert.ok(member.length > 4000 && Math.max(...visited) < 125, `each on a curve of its own, not all over the plane: ${visited}`);
  },
  basins({ ends }) {
    const near = (speed) => share(ends, (v) => Math.abs(v - speed) < 0.02), [back, forth] = [near(-0.607), near(2.04)];
    assert.ok(ends.length === 512 * 512 && back > 0.3 && forth > 0.3 && back + forth > 0.95, `${back} and ${forth} of ${ends.length}`);
  },
  typed: (runs) => assert.deepEqual(runs.map(({ final: { x } }) => Math.round(x)), [1, -1, 1]),
  digits(curves) {
    assert.equal(curves.length, 5);
    const slope = ({ points }) => {
      const good = points.filter(({ error }) => error > 1e-10 && error < 1e-2), [a, b] = [good[0], good.at(-1)];
      return -Math.log(b.error / a.error) / Math.log(b.force_evaluations / a.force_evaluations);
    };
    assert.ok(Math.abs(slope(curves[0]) - 2) < 0.4, `leapfrog pays threefold for a digit: ${slope(curves[0])}`);
    assert.ok(slope(curves[2]) > 6, `order 8: ${slope(curves[2])}`);
  },
};

/** The width of each member of a portrait in x. */
function widths({ member, x }) {
  const ends = new Map();
  member.forEach((m, i) => {
    const [low, high] = ends.get(m) ?? [Infinity, -Infinity];
    ends.set(m, [Math.min(low, x[i]), Math.max(high, x[i])]);
  });
  return [...ends.values()].map(([low, high]) => high - low);
}
