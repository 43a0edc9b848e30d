// The lessons: what each shows. Their words stand with the texts of the page, under lesson.ID.title, look and see; a name here is
// one of those under `term`, with its values where it has any, `[name, values]`, or a formula, which stands for itself.
//   scene, runs   a request and what each run has of its own, `columns` being formulas by name; a run may bear a `name`; one with
//                 `back` goes backward from the end of the run of that number
//   views         columns `x`, `y` (`error_of_energy`: |H − H₀| / |H₀|), `z` for a view in space; `log`: the axes that are
//                 logarithmic; `box`: what is seen; `exact`: known curves, functions of x or, with a range, to points; `bins`: a
//                 histogram of x; `level`: a function whose level curves lie behind; `run`: one run only; `thin`: of thin lines;
//                 `sun`: at the origin; `body`: the thing itself, by the name of a drawing or as bodies with their links;
//                 `several`: columns over x with their titles, in the place of y; `x[*]` over `y[*]`: all of a kind; `runs`: some of
//                 them; `places` that stand still; `points`: one for each run, with a tangent; `multipliers` about the unit circle
//   grows, brief  its runs are shown as they come, the first ones first; while a hand moves, one part of so many of the span is run
//   apart, layout each run in a picture of its own; how pictures stand: a "pair" above one, all in a "row"
//   one           the view of a presentation, where it is not the first
//   pace          "cycle": the runs play each at the pace of its own period, and x may be `periods`
//   curve, points states evenly along the curve instead of in time; how many
//   control       one slider: what it sets (`steps`: of all runs, in proportion), from where to where; or the `starts` of the i-th run
//                 at a value, which is `usual` at first
//   study         error over cost of some schemes, in the place of runs; portrait: where many runs cross a plane, under labels,
//                 and a `key`: what the first and the last colour say, or what all do
//   group         of this lesson and those that follow, whose heading is a text
//   tells         numbers beside each run: a name and the path to it in the answer, or a function of that
const h = (id, step, more = {}) => ({ scheme: { id, step, ...more } });
const steps = (low, high) => ({ sets: "steps", label: "step_h", low, high, log: true });
const drift = { x: "t", y: "error_of_energy", log: "y" };
const tau = 2 * Math.PI;
const orbit = { x: "x", y: "y", sun: true };
const orbits = { x: "x[*]", y: "y[*]", box: { x: [-40, 50], y: [-34, 50] }, thin: true, labels: [["in_au", { axis: "x" }], ["in_au", { axis: "y" }]] };
const ellipse = ["true_orbit", (w) => [Math.cos(w) - 0.6, 0.8 * Math.sin(w)], [0, tau]];
const fifty = { ...orbit, exact: [ellipse], thin: true }; // revolutions

// The chain of Fermi, Pasta, Ulam and Tsingou: 32 masses between walls, begun in the lowest of its modes.
const chain = Array.from({ length: 32 }, (_, i) => `q[${i + 1}]`);
const mode = (k) => ({ name: `mode${k}`, expression: `(sum(i=1..32, p[i]*sin(i*${k}*pi/33))^2 + 4*sin(${k}*pi/66)^2*sum(i=1..32, q[i]*sin(i*${k}*pi/33))^2)/33` });

// The period of a pendulum is the time of the first event; `slope(i)` is its derivative by the i-th entry of `by`.
const period = { name: "period", expression: "p", direction: "down" };
const slope = (i) => ({ sensitivities }) => sensitivities.events[0].t[i];
const mean = (a, b) => (Math.abs(a - b) < 1e-15 ? a : mean((a + b) / 2, Math.sqrt(a * b)));
const swinging = (a, { length, gravity }) => [a, (2 * Math.PI * Math.sqrt(length / gravity)) / mean(1, Math.cos(a / 2))];

// Arenstorf's orbit: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, 1993, II.0. The direction in
// which neighbours leave it fastest is an eigenvector of the derivative of one round, here with length 1 in the plane.
const round = 17.065216560157964, begins = { x: 0.994, y: 0, px: 0, py: -1.0075851063790824 };
const leaves = { x: 0.3191331921533918, y: 0.9477098742051738, px: 153.68283617198503, py: 49.99111941567811 };
const beside = (by) => Object.fromEntries(Object.entries(begins).map(([name, v]) => [name, v + by * leaves[name]]));
/** The multipliers: two are 1, for the energy and along the orbit; the others are λ and 1/λ, whose sum is the trace less 2. */
function multipliersOf({ sensitivities: { final } }) {
  const half = final.reduce((sum, row, i) => sum + row[i], -2) / 2, root = Math.sqrt(Math.max(0, half * half - 1));
  return [half + root, 1, 1, 1 / (half + root)].map((re) => ({ re, im: 0 }));
}
const growth = (outcome) => (outcome.sensitivities ? multipliersOf(outcome)[0].re : null);

const offset = ({ outcome: { initial: a } }, { outcome: { initial: b } }) => Math.hypot(a.x - b.x, a.y - b.y);

export const lessons = [
  {
    id: "orbit", group: "keeps",
    scene: { problem: { id: "kepler" }, initial: { x: 0.4, y: 0, px: 0, py: 2 }, until: { t: 50 * tau } },
    runs: [h("leapfrog", 0.15, { composition: "suzuki_4" }), h("runge_kutta_4", 0.12)],
    views: [{ ...fifty, run: 0 }, { ...fifty, run: 1 }, drift], one: fifty,
    layout: "pair", curve: true, points: 2000, control: steps(0.05, 0.2), tells: [["semi_major_axis", "diagnostics.orbit.semi_major_axis"]],
  },
  {
    id: "spiral",
    scene: { problem: { id: "harmonic_oscillator" }, initial: { q: 1, p: 0 }, until: { t: 60 } },
    runs: [h("explicit_euler", 0.3), h("explicit_midpoint", 0.3), h("leapfrog", 0.3)],
    views: [{ x: "q", y: "p", box: { x: [-2, 2], y: [-2, 2] } }, { body: "spring" }, drift], control: steps(0.02, 1),
  },
  {
    id: "pendulum",
    scene: { problem: { id: "pendulum" }, initial: { q: 2, p: 0 }, until: { t: 1200 } },
    runs: [h("leapfrog", 0.2), h("runge_kutta_4", 0.8)],
    views: [{ x: "q", y: "p", thin: true }, { body: "pendulum" }, drift], control: steps(0.05, 0.25),
  },
  {
    id: "portrait",
    scene: { problem: { id: "pendulum" }, until: { t: 14 }, scheme: { id: "leapfrog", step: 0.02, composition: "suzuki_4" } },
    runs: [{ name: "swings_little", initial: { q: 0.6, p: 0 } }, { name: "swings_far", initial: { q: 2.4, p: 0 } },
           { name: "turns_over", initial: { q: 0, p: 2.4 } }, { name: "turns_back", initial: { q: 0, p: -2.4 } },
           { name: "on_separatrix", initial: { q: 0, p: 2 } }, { name: "your_start", initial: { q: 0, p: 1.4 } }],
    views: [{ x: "q_wrapped", y: "p", labels: ["angle", "angular_velocity"], box: { x: [-Math.PI, Math.PI], y: [-2.7, 2.7] },
              exact: [["separatrix", (w) => [w, 2 * Math.cos(w / 2)], [-Math.PI, Math.PI]],
                      ["separatrix", (w) => [w, -2 * Math.cos(w / 2)], [-Math.PI, Math.PI]]] },
            { body: "pendulum" }, { x: "t", y: "q" }],
    control: { sets: "initial.p", label: "speed_of_yours", low: 0, high: 2.6, run: 5 }, tells: [],
  },
  {
    id: "clock",
    scene: { problem: { id: "pendulum", length: 0.994, gravity: 9.81 }, initial: { p: 0 }, until: { t: 8 }, scheme: { id: "taylor", tolerance: 1e-12 },
             events: [period], sensitivities: { by: ["/initial/q", "/problem/length"] } },
    runs: [...[0.1, 0.5, 1, 1.5, 2].map((q) => ({ name: ["from_angle", { q }], initial: { q } })), { name: "your_clock", initial: { q: 0.2 } }],
    views: [{ points: { x: ({ initial }) => initial.q, y: ({ events }) => events[0].t, slope: slope(0) }, labels: ["swing", "period_in_s"],
              exact: [["exact_period", swinging, [0, 2.4]]] }, { body: "pendulum" }, { x: "t", y: "q", labels: ["t, s", "angle"] }],
    control: { sets: "initial.q", label: "swing_of_yours", low: 0.02, high: 2.5, run: 5 },
    tells: [["T, s", "events.0.t"], ["dT/dA", slope(0)], ["dT/dl", slope(1)],
            ["day_of_degree", (outcome) => (slope(0)(outcome) / outcome.events[0].t) * 480 * Math.PI]],
  },
  {
    id: "paper",
    scene: { problem: { id: "kepler" }, until: { t: 95 } }, apart: true, layout: "row", curve: true,
    runs: [h("leapfrog", 0.01), h("leapfrog", 0.005), h("jacobi_maupertuis", 0.01, { theta: 0.01 }),
           { scheme: { id: "time_transformed", preset: "kepler", sigma: 0.05 } }],
    views: [orbit], control: { sets: "until.t", label: "until_t", low: 19, high: 190 },
    tells: [["apsis", "diagnostics.orbit.apsidal_rotation"]],
  },
  {
    id: "planets",
    scene: { problem: { id: "outer_solar_system" }, until: { t: 200000 } }, runs: [h("leapfrog", 100), h("runge_kutta_4", 400)], points: 2000,
    views: [{ ...orbits, run: 0 }, { ...orbits, run: 1 }, drift], one: orbits,
    layout: "pair", control: steps(20, 200), tells: [["h_at_end", "trajectory.energy.last"]],
  },
  {
    id: "chain",
    scene: { problem: { id: "fermi_pasta_ulam", alpha: 0.25 }, until: { t: 11000 }, columns: [1, 2, 3, 4].map(mode) },
    runs: [{ ...h("leapfrog", 0.4), name: ["leapfrog_of", { h: 0.4 }] }], points: 800, brief: 4,
    views: [{ x: "t", box: { x: [0, 11000] }, several: [1, 2, 3, 4].map((k) => [`mode${k}`, ["mode", { k }]]), labels: ["t", "mode_energy"] },
            { body: chain.map((name, i) => ({ at: [String(i / 10), name], linked: i ? [i - 1] : [] })) }],
    control: { sets: "problem.alpha", label: "nonlinearity", low: 0, high: 0.3 }, tells: [],
  },
  {
    id: "frame",
    scene: { problem: { id: "restricted_three_body", mu: 0.012277471 }, initial: { x: 0.3, y: 0, z: 0, px: 0, py: 1.78, pz: 0 }, until: { t: 13950 },
             columns: [{ name: "r", expression: "sqrt((x + mu)^2 + y^2)" }] },
    runs: [h("lifted_splitting", 0.03), h("runge_kutta_4", 0.03)], grows: true, brief: 10,
    views: [{ x: "t", y: "r", box: { x: [0, 13950] }, labels: ["t", "distance"], thin: true }, { ...drift, box: { x: [0, 13950] } }], points: 2000, control: steps(0.025, 0.035),
  },
  {
    id: "damped", group: "friction",
    scene: { problem: { id: "damped_oscillator", damping: 0.1 }, initial: { q: 1, p: 0 }, until: { t: 300 } },
    runs: [h("contact_leapfrog", 0.3), h("runge_kutta_4", 1.2)],
    views: [{ x: "t", y: "mechanical_energy", log: "y", exact: [["½ e⁻ᵅᵗ", (t, { damping }) => 0.5 * Math.exp(-damping * t)]] },
            { x: "q", y: "p" }],
    control: { sets: "problem.damping", label: "damping", low: 0.02, high: 0.5, log: true },
    tells: [["mechanical_at_end", "trajectory.mechanical_energy.last"]],
  },
  {
    id: "driven",
    scene: { problem: { id: "driven_oscillator", damping: 0.2, amplitude: 0.3, frequency: 1.5 }, until: { t: 60 },
             scheme: { id: "contact_leapfrog", step: 0.05 } },
    runs: [{ name: ["start_at", { q: -1.5 }], initial: { q: -1.5, p: 0 } }, { name: "start_at_rest", initial: { q: 0, p: 0 } },
           { name: "start_with_kick", initial: { q: 1, p: 1.5 } }],
    views: [{ x: "t", y: "q" }, { body: "spring" }, { x: "q", y: "p" }],
    control: { sets: "problem.frequency", label: "frequency", low: 0.3, high: 3 },
    tells: [["q_at_end", "final.q"]],
  },
  {
    id: "orders",
    scene: { problem: { id: "perturbed_kepler", preset: "circular" }, until: { t: 20 } },
    runs: [h("contact_splitting", 0.1), h("contact_splitting", 0.1, { composition: "suzuki_4" }),
           h("contact_splitting", 0.1, { composition: "kahan_li_6" }), h("contact_splitting", 0.1, { composition: "kahan_li_8" })],
    views: [{ x: "t", y: "distance", between: ["x", "y"], log: "y" }, orbit], control: steps(0.02, 0.5),
    tells: [["x_at_end", "final.x"]],
  },
  {
    id: "backward",
    scene: { problem: { id: "damped_pendulum", damping: 0.1 }, initial: { q: 2.5, p: 0 }, until: { t: 48 },
             columns: [{ name: "height", expression: "p^2/2 + 1 - cos(q)" }] },
    runs: [{ ...h("contact_leapfrog", 0.3), name: "contact_leapfrog" }, { ...h("contact_leapfrog", 0.3), name: "and_back", back: 0 },
           { ...h("runge_kutta_4", 1.2), name: "runge_kutta_4" }, { ...h("runge_kutta_4", 1.2), name: "and_back", back: 2 }],
    views: [{ x: "t", y: "height", labels: ["t", "pendulum_energy"] }, { body: "pendulum" }, { x: "q", y: "p" }],
    control: steps(0.05, 0.4), tells: [["q_at_end", "final.q"]],
  },
  {
    id: "bounce",
    scene: { problem: { id: "bouncing_ball" }, until: { t: 40 }, scheme: { id: "leapfrog", step: 0.05 },
             events: [{ name: "floor", expression: "x", direction: "down", set: { vx: "-e*vx" } }] },
    runs: [{ name: "e = 0.5", problem: { e: 0.5 } }, { name: "e = 0.7", problem: { e: 0.7 } }, { name: ["your", { letter: "e" }], problem: { e: 0.8 } }],
    views: [{ x: "t", y: "x", labels: ["t", "height"] }, { x: "x", y: "px", labels: ["height", "velocity"] }],
    control: { sets: "problem.e", label: "e", low: 0.3, high: 0.9, run: 2 },
    tells: [["bounces", "acts.0.count"], ["rest_at", "stop.singular_at"]],
  },
  {
    id: "stars",
    scene: { problem: { id: "lane_emden", n: 3 }, until: { t: 10 }, scheme: { id: "contact_splitting", step: 0.01 } },
    runs: [{ name: "n = 0", problem: { n: 0 } }, { name: "n = 1", problem: { n: 1 } }, { name: "n = 5", problem: { n: 5 } },
           { name: ["your", { letter: "n" }] }],
    views: [{ x: "t", y: "q", labels: ["radius", "θ"],
              exact: [["1 − ξ²/6", (t) => (t < Math.sqrt(6) ? 1 - (t * t) / 6 : null)],
                      ["sin ξ / ξ", (t) => (t < Math.PI ? Math.sin(t || 1e-9) / (t || 1e-9) : null)],
                      ["1 / √(1 + ξ²/3)", (t) => 1 / Math.sqrt(1 + (t * t) / 3)]] }],
    control: { sets: "problem.n", label: "n", low: 0, high: 6, run: 3 }, tells: [["surface", "diagnostics.zeros.0"]],
  },
  {
    id: "relaxation",
    scene: { problem: { id: "van_der_pol" }, initial: { x: 2, v: 0 }, scheme: { id: "dormand_prince_5", tolerance: 1e-6 } },
    apart: true, grows: true, pace: "cycle", one: { x: "periods", y: "x" },
    runs: [{ name: "ε = 1", problem: { epsilon: 1 }, until: { t: 14 } }, { name: "ε = 10", problem: { epsilon: 10 }, until: { t: 40 } },
           { name: "ε = 100", problem: { epsilon: 100 }, until: { t: 330 } },
           { name: "ε = 1000", problem: { epsilon: 1000 }, until: { t: 3300 }, ...h("runge_kutta_4", 0.0005) }],
    views: [{ x: "t", y: "x" }], control: { sets: "problem.epsilon", label: "first_epsilon", low: 0.1, high: 20, log: true, run: 0 },
    tells: [["period", "diagnostics.cycle.period"], ["amplitude", "diagnostics.cycle.amplitude"]],
  },
  {
    id: "capture",
    scene: { problem: { id: "spin_orbit", preset: "capture" }, until: { t: 4000 }, scheme: { id: "contact_leapfrog", step: tau / 40 } },
    points: 16000,
    runs: [{ name: "three_turns", initial: { q: 2.7, p: 3 } }, { name: "two_turns", initial: { q: 1, p: 2 } },
           { name: "half_turn", initial: { q: 0, p: 0.5 } }],
    views: [{ x: "t", y: "p", labels: ["time", "spin"] }, { body: "moon" }],
    control: { sets: "problem.epsilon", label: "oblong", low: 0.001, high: 0.1, log: true }, tells: [["spin_at_end", "final.p"]],
  },
  {
    id: "islands", group: "many",
    portrait: { problem: { id: "spin_orbit", epsilon: 0.0075 }, initial: { q: 0, p: 1 }, until: { t: 300 * tau },
                scheme: { id: "contact_leapfrog", step: tau / 40 }, section: { period: tau, phase: 0 }, columns: ["q_wrapped", "p"],
                keep: ["section"], members: { vary: { "/initial/p": { grid: [0.7, 1.7, 40] } } } },
    labels: ["angle", "spin"], key: [["spin_at_start", { v: 0.7 }], "1.7"], control: { sets: "problem.epsilon", label: "oblong", low: 0.001, high: 0.1, log: true },
  },
  {
    id: "arenstorf",
    scene: { problem: { id: "custom", title: "arenstorf", variables: ["x", "y"], parameters: { mu: 0.012277471 },
                        lagrangian: "((vx - y)^2 + (vy + x)^2)/2 + (1 - mu)/sqrt((x + mu)^2 + y^2) + mu/sqrt((x - 1 + mu)^2 + y^2)",
                        bodies: [{ at: ["x", "y"] }, { at: ["-mu", "0"], kind: "sun" }, { at: ["1 - mu", "0"], kind: "planet" }] },
             initial: begins, until: { t: 3 * round }, scheme: { id: "taylor", tolerance: 1e-14 } },
    points: 6001,
    runs: [{ name: "one_round", until: { t: round }, sensitivities: { by: "initial" } }, { name: "a_neighbour" }, { name: "other_side" }, { name: "three_rounds" }],
    views: [{ x: "x", y: "y", box: { x: [-1.6, 1.6], y: [-1.4, 1.4] }, places: [["earth", ({ mu }) => -mu, () => 0], ["moon", ({ mu }) => 1 - mu, () => 0]] },
            { multipliers: multipliersOf, run: 0, labels: ["multipliers", ""] },
            { x: "t", y: "distance", between: ["x", "y"], runs: [1, 2], log: "y", labels: ["t", "distance"],
              exact: [["as_multiplied", (t, _, [once, near, , orbit]) => offset(near, orbit) * growth(once.outcome) ** (t / round)]] }],
    layout: "pair", control: { starts: (by, i) => beside([0, by, -by, 0][i]), usual: 1e-7, label: "how_near", low: 1e-9, high: 1e-4, log: true },
    tells: [["largest_multiplier", growth]],
  },
  {
    id: "galaxy",
    portrait: { problem: { id: "henon_heiles" }, until: { t: 1500 }, scheme: { id: "leapfrog", step: 0.1, composition: "suzuki_4" },
                section: { expression: "x", direction: "up" }, columns: ["y", "py"], keep: ["section"], surface: { energy: 1 / 12, starts: 10 } },
    labels: ["y", "momentum_of_y"], key: ["starts_at_rest", "starts_faster"],
    control: { sets: "surface.energy", label: "energy", low: 0.02, high: 1 / 6 },
  },
  {
    id: "basins",
    portrait: { problem: { id: "custom", title: "driven_pendulum", variables: ["q"], parameters: { a: 2, alpha: 0.2 },
                           potential: "-cos(q) - a*q*cos(t)", damping: "alpha", a: 2 },
                initial: { q: 0, p: 0 }, until: { t: 40 * tau }, scheme: { id: "contact_splitting", step: tau / 48 }, columns: ["p"],
                limits: { seconds: 60 }, keep: ["final"],
                members: { vary: { "/initial/q": { grid: [-Math.PI, Math.PI, 512] }, "/initial/p": { grid: [-2, 4, 512] } } } },
    labels: ["angle_at_start", "velocity_at_start"], key: ["velocity_at_end"], control: { sets: "problem.a", label: "drive", low: 1.8, high: 2.2 },
  },
  {
    id: "cosmos", group: "geometries",
    scene: { problem: { id: "cosmological_oscillator", gamma: 1, R: 1 }, until: { t: 20 } },
    runs: [{ ...h("contact_splitting", 0.02), initial: { q: 0.5, p: 0.3, s: -1.2884098726725126 } },
           { ...h("contact_splitting", 0.02), initial: { q: -0.05, p: 0, s: -1.4133294025102578 } },
           { ...h("explicit_euler", 0.1), initial: { q: 0.5, p: 0.3, s: -1.2884098726725126 } }],
    views: [{ x: "q", y: "p", z: "s", ball: Math.SQRT2 }, { x: "t", y: "energy" }], curve: true,
    control: { sets: "until.t", label: "until_t", low: 2, high: 20 }, tells: [["h_at_end", "trajectory.energy.last"]],
  },
  {
    id: "bath",
    scene: { problem: { id: "thermostat", beta: 1 }, until: { t: 20000 }, scheme: { id: "contact_splitting", step: 0.05 } },
    points: 40000,
    runs: [{ name: ["narrow", { scale: 0.1 }], problem: { scale: 0.1 } }, { name: ["wide", { scale: 1 }], problem: { scale: 1 } }],
    views: [{ x: "q", bins: [-4, 4, 40], labels: ["q", "density"],
              exact: [["gaussian", (q, { beta }) => Math.sqrt(beta / tau) * Math.exp((-beta * q * q) / 2)]] }],
    control: { sets: "until.t", label: "until_t", low: 200, high: 20000, log: true }, tells: [],
  },
  {
    id: "downhill",
    scene: { problem: { id: "gradient_flow" }, until: { t: 12 }, scheme: { id: "contact_splitting", step: 0.05 } },
    runs: [[0.1, 1], [-1.6, 1.2], [1.6, 1], [-1.2, -1.2], [1, -1.3], [-0.2, 1.4]].map(([x, y]) => (
      { name: ["from_place", { x, y }], initial: { x, y } })),
    views: [{ x: "x", y: "y", level: (x, y, { a, b, c }) => (a * (x * x - 1) ** 2) / 4 + (b * y * y) / 2 + c * x * y }, { x: "t", y: "potential" }],
    control: { sets: "problem.c", label: "tilt", low: -0.9, high: 0.9 }, tells: [["ends_at", "final.x"]],
  },
  {
    id: "typed",
    scene: { problem: { id: "custom", title: "double_well", variables: ["x"], parameters: { alpha: 0.1 },
                        lagrangian: "vx^2/2 + x^2/2 - x^4/4 - alpha*s", alpha: 0.1 },
             until: { t: 60 }, scheme: { id: "contact_splitting", step: 0.05, composition: "suzuki_4" } },
    runs: [{ name: ["from", { x: 1.6 }], initial: { x: 1.6, px: 0 } }, { name: ["from", { x: 2 }], initial: { x: 2, px: 0 } },
           { name: ["from", { x: 2.2 }], initial: { x: 2.2, px: 0 } }],
    views: [{ x: "t", y: "x" }, { x: "x", y: "px" }], control: { sets: "problem.alpha", label: "friction", low: 0.02, high: 0.5, log: true },
    tells: [["x_at_end", "final.x"]],
  },
  {
    id: "heat",
    scene: { problem: { id: "generic_oscillator" }, until: { t: 50 } },
    runs: [h("contact_splitting", 0.2), h("explicit_euler", 0.2), h("explicit_midpoint", 0.4)],
    views: [{ x: "t", y: "energy", box: { y: [1.4, 2] } }, { x: "t", y: "entropy", box: { y: [0, 0.8] } }], control: steps(0.02, 0.5),
    tells: [["entropy_gained", "diagnostics.entropy.final"]],
  },
  {
    id: "butterfly",
    scene: { problem: { id: "lorenz" }, until: { t: 40 }, scheme: { id: "runge_kutta_4", step: 0.005 } },
    runs: [{ name: "x = 1", initial: { x: 1 } }, { name: "x = 1.000001", initial: { x: 1.000001 } },
           { name: "x = 1.000002", initial: { x: 1.000002 } }],
    views: [{ x: "x", y: "z" }, { x: "t", y: "x" }], one: { x: "t", y: "x" }, control: { sets: "problem.rho", label: "heating", low: 0.5, high: 40 },
    tells: [["x_at_end", "final.x"]],
  },
  {
    id: "digits", group: "price",
    study: { problem: { id: "kepler" }, initial: { x: 0.4, y: 0, px: 0, py: 2 }, until: { t: 20 * Math.PI }, error: "max",
             schemes: ["leapfrog", { id: "leapfrog", composition: "suzuki_4" }, { id: "leapfrog", composition: "kahan_li_8" },
                       "runge_kutta_4", "time_transformed"], budget_seconds: 2 },
  },
];
