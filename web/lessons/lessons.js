// The lessons: each a claim, the runs that show it, and the words beside them.
//   scene, runs   a request and what each run has of its own, `columns` being formulas by name; a run may bear a `name`; one with
//                 `back` goes backward from the end of the run of that number
//   views         columns `x`, `y` (`error_of_energy`: |H − H₀| / |H₀|), `z` for a view in space; `log`: the axes that are
//                 logarithmic; `box`: what is seen; `exact`: known curves, functions of x or, with a range, to points; `bins`: a
//                 histogram of x; `level`: a function whose level curves lie behind; `run`: one run only; `thin`: of thin lines;
//                 `sun`: at the origin; `body`: the thing itself, by the name of a drawing or as bodies with their links;
//                 `several`: columns over x with their titles, in the place of y; `x[*]` over `y[*]`: all of a kind
//   apart, layout each run in a picture of its own; how pictures stand: a "pair" above one, all in a "row"
//   one           the view of a presentation, where it is not the first
//   pace          "cycle": the runs play each at the pace of its own period, and x may be `periods`
//   curve, points states evenly along the curve instead of in time; how many
//   control       one slider: what it sets (`steps`: of all runs, in proportion), from where to where
//   study         error over cost of some schemes, in the place of runs; portrait: where many runs cross a plane, under labels,
//                 and a `key`: what the first and the last colour say, or what all do
//   group         the heading above this lesson and those that follow
//   tells         numbers beside each run: a name and the path to it in the answer
const h = (id, step, more = {}) => ({ scheme: { id, step, ...more } });
const steps = (low, high) => ({ sets: "steps", label: "step h", low, high, log: true });
const drift = { x: "t", y: "error_of_energy", log: "y" };
const tau = 2 * Math.PI;
const orbit = { x: "x", y: "y", sun: true };
const ellipse = ["the true orbit", (w) => [Math.cos(w) - 0.6, 0.8 * Math.sin(w)], [0, tau]];
const fifty = { ...orbit, exact: [ellipse], thin: true }; // revolutions

// The outer solar system: Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006, I.2.4; au, days, masses of the sun.
const outer = {
  problem: { id: "custom", title: "Outer solar system", variables: ["x[6]", "y[6]", "z[6]"],
             parameters: { G: 2.95912208286e-4, m: [1.00000597682, 0.000954786104043, 0.000285583733151, 0.0000437273164546,
                                                    0.0000517759138449, 7.692307692e-9] },
             definitions: { "d(i,j)": "sqrt((x[i]-x[j])^2 + (y[i]-y[j])^2 + (z[i]-z[j])^2)" },
             potential: "-G*sum(i=1..6, j=i+1..6, m[i]*m[j]/d(i,j))", masses: { x: "m", y: "m", z: "m" } },
  initial: { x: [0, -3.5023653, 9.0755314, 8.310142, 11.4707666, -15.5387357], y: [0, -3.8169847, -3.0458353, -16.2901086, -25.7294829, -25.2225594],
             z: [0, -1.5507963, -1.6483708, -7.2521278, -10.8169456, -3.1902382], vx: [0, 0.00565429, 0.00168318, 0.00354178, 0.0028893, 0.00276725],
             vy: [0, -0.0041249, 0.00483525, 0.00137102, 0.00114527, -0.00170702], vz: [0, -0.00190589, 0.00192462, 0.00055029, 0.00039677, -0.00136504] },
  until: { t: 200000 },
};

// The chain of Fermi, Pasta, Ulam and Tsingou: 32 masses between walls, begun in the lowest of its modes.
const chain = Array.from({ length: 32 }, (_, i) => `q[${i + 1}]`);
const mode = (k) => ({ name: `mode${k}`, expression: `(sum(i=1..n, p[i]*sin(i*${k}*pi/33))^2 + 4*sin(${k}*pi/66)^2*sum(i=1..n, q[i]*sin(i*${k}*pi/33))^2)/33` });

export const lessons = [
  {
    id: "orbit", group: "What a scheme keeps, and what it loses", title: "At equal work, one scheme keeps the orbit and the other loses it",
    look: "Both runs evaluate the force equally often, over fifty revolutions. Watch the orbit of Runge–Kutta shrink.",
    see: "The symplectic scheme turns the ellipse a little and keeps its size: the energy error swings and stays bounded for " +
         "ever. That of Runge–Kutta grows with every revolution. A longer step makes the difference larger.",
    scene: { problem: { id: "kepler" }, initial: { x: 0.4, y: 0, px: 0, py: 2 }, until: { t: 50 * tau } },
    runs: [h("leapfrog", 0.15, { composition: "suzuki_4" }), h("runge_kutta_4", 0.12)],
    views: [{ ...fifty, run: 0 }, { ...fifty, run: 1 }, drift], one: fifty,
    layout: "pair", curve: true, control: steps(0.05, 0.2), tells: [["semi-major axis (true: 1)", "diagnostics.orbit.semi_major_axis"]],
  },
  {
    id: "spiral", title: "Euler spirals out; leapfrog comes back to its circle",
    look: "A mass on a spring, seen by its place and momentum: the true curve is the circle. The step is long, to see what " +
          "each scheme does.",
    see: "Euler gains energy at every step, the midpoint rule slowly; leapfrog's curve closes, slightly out of round.",
    scene: { problem: { id: "harmonic_oscillator" }, initial: { q: 1, p: 0 }, until: { t: 60 } },
    runs: [h("explicit_euler", 0.3), h("explicit_midpoint", 0.3), h("leapfrog", 0.3)],
    views: [{ x: "q", y: "p", box: { x: [-2, 2], y: [-2, 2] } }, { body: "spring" }, drift], control: steps(0.02, 1),
  },
  {
    id: "pendulum", title: "A pendulum without friction does not come to rest, unless the scheme brakes it",
    look: "The same number of force evaluations again, over some hundred and forty swings. Play it and see who still swings high.",
    see: "Runge–Kutta's swings shrink as if there were friction. Leapfrog's stay, at a step four times as short.",
    scene: { problem: { id: "pendulum" }, initial: { q: 2, p: 0 }, until: { t: 1200 } },
    runs: [h("leapfrog", 0.2), h("runge_kutta_4", 0.8)],
    views: [{ x: "q", y: "p", thin: true }, { body: "pendulum" }, drift], control: steps(0.05, 0.25),
  },
  {
    id: "portrait", title: "All motions of a pendulum in one picture: to and fro, round and round, and one between",
    look: "Angle and speed of a pendulum from six starts: a portrait of all that it can do. The dashed curve is the separatrix.",
    see: "Within the separatrix the pendulum swings to and fro: closed curves, round where the swing is small. Beyond it, it turns " +
         "over and over. On it, it climbs for ever and never reaches the top. Give the last start more speed: at 2 it changes over.",
    scene: { problem: { id: "pendulum" }, until: { t: 14 }, scheme: { id: "leapfrog", step: 0.02, composition: "suzuki_4" } },
    runs: [{ name: "swings a little", initial: { q: 0.6, p: 0 } }, { name: "swings far", initial: { q: 2.4, p: 0 } },
           { name: "turns over", initial: { q: 0, p: 2.4 } }, { name: "turns the other way", initial: { q: 0, p: -2.4 } },
           { name: "on the separatrix", initial: { q: 0, p: 2 } }, { name: "your start at the bottom", initial: { q: 0, p: 1.4 } }],
    views: [{ x: "q_wrapped", y: "p", labels: ["angle", "angular velocity"], box: { x: [-Math.PI, Math.PI], y: [-2.7, 2.7] },
              exact: [["separatrix", (w) => [w, 2 * Math.cos(w / 2)], [-Math.PI, Math.PI]],
                      ["separatrix", (w) => [w, -2 * Math.cos(w / 2)], [-Math.PI, Math.PI]]] },
            { body: "pendulum" }, { x: "t", y: "q" }],
    control: { sets: "initial.p", label: "speed of your start", low: 0, high: 2.6, run: 5 }, tells: [],
  },
  {
    id: "paper", title: "An ellipse that turns is an error of the scheme; a hybrid holds it still",
    look: "The orbit of Nair, Ober-Blöbaum and Marsden, five revolutions with four schemes. The true ellipse does not turn.",
    see: "Half the step turns the apsis a quarter as much. The hybrid steps in space where the planet is fast (the marked " +
         "stretch), transformed time slows down there: both hold the ellipse.",
    scene: { problem: { id: "kepler" }, until: { t: 95 } }, apart: true, layout: "row", curve: true,
    runs: [h("leapfrog", 0.01), h("leapfrog", 0.005), h("jacobi_maupertuis", 0.01, { theta: 0.01 }),
           { scheme: { id: "time_transformed", preset: "kepler", sigma: 0.05 } }],
    views: [orbit], control: { sets: "until.t", label: "until t", low: 19, high: 190 },
    tells: [["apsis turns, rad a revolution", "diagnostics.orbit.apsidal_rotation"]],
  },
  {
    id: "planets", title: "Two hundred thousand days of the outer planets: the energy stays, or Jupiter is thrown out",
    look: "The sun and the planets from Jupiter to Pluto, with two thousand evaluations of all forces by each scheme: steps of 100 days or of 400.",
    see: "With leapfrog all orbits stay where they are for five centuries, and the energy error swings within bounds. Runge–Kutta, of twice its " +
         "order, lets the energy drift: Jupiter spirals inward until it is thrown out. Shorter steps put that off.",
    scene: outer, runs: [h("leapfrog", 100), h("runge_kutta_4", 400)], points: 2000,
    views: [{ x: "x[*]", y: "y[*]", box: { x: [-40, 50], y: [-34, 50] }, thin: true, run: 0, labels: ["x, au", "y, au"] },
            { x: "x[*]", y: "y[*]", box: { x: [-40, 50], y: [-34, 50] }, thin: true, run: 1, labels: ["x, au", "y, au"] }, drift],
    layout: "pair", control: steps(20, 200), tells: [["H at the end", "trajectory.energy.last"]],
  },
  {
    id: "chain", title: "A chain that shares its energy among its modes gives it back to the first",
    look: "The 32 masses of Fermi, Pasta, Ulam and Tsingou, their springs a little nonlinear, begun in the lowest mode: the energies of four modes.",
    see: "The energy leaves the first mode for the others, as if it would spread to all. It does not: after some 10,000 units of time " +
         "nearly all is in the first mode again. Without the nonlinear part α nothing leaves it.",
    scene: { problem: { id: "custom", title: "Fermi–Pasta–Ulam–Tsingou chain", variables: ["q[n]"], parameters: { n: 32, alpha: 0.25 },
                        definitions: { "at(i)": "if(i == 0 or i > n, 0, q[i])", "d(i)": "at(i+1) - at(i)" },
                        potential: "sum(i=0..n, d(i)^2/2 + alpha*d(i)^3/3)", alpha: 0.25 },
             initial: { q: chain.map((_, i) => Math.sin((Math.PI * (i + 1)) / 33)) }, until: { t: 11000 }, columns: [1, 2, 3, 4].map(mode) },
    runs: [{ ...h("leapfrog", 0.4), name: "leapfrog, h\u00a0=\u00a00.4" }], points: 800,
    views: [{ x: "t", several: [1, 2, 3, 4].map((k) => [`mode${k}`, `mode ${k}`]), labels: ["t", "energy of a mode"] },
            { body: chain.map((name, i) => ({ at: [String(i / 10), name], linked: i ? [i - 1] : [] })) }],
    control: { sets: "problem.alpha", label: "nonlinearity α", low: 0, high: 0.3 }, tells: [],
  },
  {
    id: "damped", group: "Friction, drive and time", title: "Friction takes energy at a rate of its own, and a contact scheme keeps that rate",
    look: "A damped oscillator at long steps and equal work. The dashed line is the law of decay, e^{−αt}.",
    see: "Runge–Kutta damps faster than the friction does. The contact scheme follows the law over thirteen decades.",
    scene: { problem: { id: "damped_oscillator", damping: 0.1 }, initial: { q: 1, p: 0 }, until: { t: 300 } },
    runs: [h("contact_leapfrog", 0.3), h("runge_kutta_4", 1.2)],
    views: [{ x: "t", y: "mechanical_energy", log: "y", exact: [["½ e⁻ᵅᵗ", (t, { damping }) => 0.5 * Math.exp(-damping * t)]] },
            { x: "q", y: "p" }],
    control: { sets: "problem.damping", label: "damping α", low: 0.02, high: 0.5, log: true },
    tells: [["mechanical energy at the end", "trajectory.mechanical_energy.last"]],
  },
  {
    id: "driven", title: "Whatever the start, the drive has the last word",
    look: "A damped oscillator that is pushed in a steady rhythm, from three starts. They fall together.",
    see: "After some ten swings the starts are forgotten, and all three move in the rhythm of the drive. Near its own " +
         "frequency, 1, the swing is largest.",
    scene: { problem: { id: "driven_oscillator", damping: 0.2, amplitude: 0.3, frequency: 1.5 }, until: { t: 60 },
             scheme: { id: "contact_leapfrog", step: 0.05 } },
    runs: [{ name: "start at q = −1.5", initial: { q: -1.5, p: 0 } }, { name: "start at rest", initial: { q: 0, p: 0 } },
           { name: "start with a kick", initial: { q: 1, p: 1.5 } }],
    views: [{ x: "t", y: "q" }, { body: "spring" }, { x: "q", y: "p" }],
    control: { sets: "problem.frequency", label: "frequency Ω", low: 0.3, high: 3 },
    tells: [["q at the end", "final.q"]],
  },
  {
    id: "orders", title: "Each higher order buys digits, if the motion is smooth",
    look: "A planet whose medium brakes and pushes it by turns; one step size, contact schemes of order 2, 4, 6, " +
          "and 8, which the others are measured against.",
    see: "At this step two more orders buy two more digits, and cost more force evaluations. With long steps the orders lie " +
         "close together: a high order wants a step short enough.",
    scene: { problem: { id: "perturbed_kepler", preset: "circular" }, until: { t: 20 } },
    runs: [h("contact_splitting", 0.1), h("contact_splitting", 0.1, { composition: "suzuki_4" }),
           h("contact_splitting", 0.1, { composition: "kahan_li_6" }), h("contact_splitting", 0.1, { composition: "kahan_li_8" })],
    views: [{ x: "t", y: "distance", between: ["x", "y"], log: "y" }, orbit], control: steps(0.02, 0.5),
    tells: [["x at the end", "final.x"]],
  },
  {
    id: "backward", title: "Run backward, friction gives its energy back, and a symmetric scheme finds the start again",
    look: "A pendulum with friction over eight swings, and from its end backward in time: contact leapfrog, and Runge–Kutta with the same work.",
    see: "Backward, what slowed the swing drives it. The symmetric scheme undoes each of its steps and is back at q = 2.5 to the " +
         "last digits, at any step. Runge–Kutta's errors do not undo each other: it comes to another start.",
    scene: { problem: { id: "damped_pendulum", damping: 0.1 }, initial: { q: 2.5, p: 0 }, until: { t: 48 },
             columns: [{ name: "height", expression: "p^2/2 + 1 - cos(q)" }] },
    runs: [{ ...h("contact_leapfrog", 0.3), name: "contact leapfrog" }, { ...h("contact_leapfrog", 0.3), name: "and back", back: 0 },
           { ...h("runge_kutta_4", 1.2), name: "Runge–Kutta 4" }, { ...h("runge_kutta_4", 1.2), name: "and back", back: 2 }],
    views: [{ x: "t", y: "height", labels: ["t", "energy, p²/2 + 1 − cos q"] }, { body: "pendulum" }, { x: "q", y: "p" }],
    control: steps(0.05, 0.4), tells: [["q at the end", "final.q"]],
  },
  {
    id: "bounce", title: "A ball that loses a part of its speed at every bounce has bounced infinitely often before it rests",
    look: "Three balls fall from the height 1 where g = 1; each bounce leaves a part e of the speed. The bounces follow each other ever faster.",
    see: "The times between bounces shrink by e: their sum is finite, √2 (1 + e)/(1 − e), for e = 0.8 nine times √2. The run ends " +
         "there and says so. Nearer to 1 the ball bounces longer.",
    scene: { problem: { id: "custom", title: "Bouncing ball", variables: ["x"], parameters: { g: 1, e: 0.8 }, potential: "g*x" },
             initial: { x: 1, vx: 0 }, until: { t: 40 }, scheme: { id: "leapfrog", step: 0.05 },
             events: [{ name: "floor", expression: "x", direction: "down", set: { vx: "-e*vx" } }] },
    runs: [{ name: "e = 0.5", problem: { e: 0.5 } }, { name: "e = 0.7", problem: { e: 0.7 } }, { name: "your e", problem: { e: 0.8 } }],
    views: [{ x: "t", y: "x", labels: ["t", "height"] }, { x: "x", y: "px", labels: ["height", "velocity"] }],
    control: { sets: "problem.e", label: "e", low: 0.3, high: 0.9, run: 2 },
    tells: [["bounces", "acts.0.count"], ["at rest at t", "stop.singular_at"]],
  },
  {
    id: "stars", title: "How a star ends depends on one number",
    look: "A star from its centre outward: its density falls as θⁿ, its pressure as θⁿ⁺¹. For n = 0, 1 and 5 formulas of θ are " +
          "known; one n is yours.",
    see: "The runs lie on the dashed formulas. The surface, where a curve meets zero, moves outward with n; from n = 5 on " +
         "there is none.",
    scene: { problem: { id: "lane_emden", n: 3 }, until: { t: 10 }, scheme: { id: "contact_splitting", step: 0.01 } },
    runs: [{ name: "n = 0", problem: { n: 0 } }, { name: "n = 1", problem: { n: 1 } }, { name: "n = 5", problem: { n: 5 } },
           { name: "your n" }],
    views: [{ x: "t", y: "q", labels: ["radius ξ", "θ"],
              exact: [["1 − ξ²/6", (t) => (t < Math.sqrt(6) ? 1 - (t * t) / 6 : null)],
                      ["sin ξ / ξ", (t) => (t < Math.PI ? Math.sin(t || 1e-9) / (t || 1e-9) : null)],
                      ["1 / √(1 + ξ²/3)", (t) => 1 / Math.sqrt(1 + (t * t) / 3)]] }],
    control: { sets: "problem.n", label: "n", low: 0, high: 6, run: 3 }, tells: [["surface at ξ", "diagnostics.zeros.0"]],
  },
  {
    id: "relaxation", title: "The same equation swings, or creeps and jumps",
    look: "The van der Pol oscillator over two of its cycles, from ε = 1 to ε = 1000. Compare the shapes.",
    see: "A sine becomes a slow creep with sudden jumps; the height stays 2, the period grows in proportion to ε.",
    scene: { problem: { id: "van_der_pol" }, initial: { x: 2, v: 0 }, scheme: { id: "dormand_prince_5", tolerance: 1e-6 } },
    apart: true, pace: "cycle", one: { x: "periods", y: "x" },
    runs: [{ name: "ε = 1", problem: { epsilon: 1 }, until: { t: 14 } }, { name: "ε = 10", problem: { epsilon: 10 }, until: { t: 40 } },
           { name: "ε = 100", problem: { epsilon: 100 }, until: { t: 330 } },
           { name: "ε = 1000", problem: { epsilon: 1000 }, until: { t: 3300 }, ...h("runge_kutta_4", 0.0005) }],
    views: [{ x: "t", y: "x" }], control: { sets: "problem.epsilon", label: "ε of the first", low: 0.1, high: 20, log: true, run: 0 },
    tells: [["period", "diagnostics.cycle.period"], ["amplitude", "diagnostics.cycle.amplitude"]],
  },
  {
    id: "capture", title: "A moon that turns too fast is braked until it shows one face",
    look: "Spin of a moon against time, in units of its revolutions: three moons begin at different spins, and tides brake them.",
    see: "All three slow down to one turn per revolution, are captured there and sway about it.",
    scene: { problem: { id: "spin_orbit", preset: "capture" }, until: { t: 4000 }, scheme: { id: "contact_leapfrog", step: tau / 40 } },
    points: 16000,
    runs: [{ name: "from three turns", initial: { q: 2.7, p: 3 } }, { name: "from two turns", initial: { q: 1, p: 2 } },
           { name: "from half a turn", initial: { q: 0, p: 0.5 } }],
    views: [{ x: "t", y: "p", labels: ["time", "spin"] }, { body: "moon" }],
    control: { sets: "problem.epsilon", label: "how oblong, ε", low: 0.001, high: 0.1, log: true }, tells: [["spin at the end", "final.p"]],
  },
  {
    id: "islands", group: "Many runs at once", title: "An island of moons that show one face, in a sea of moons that turn on",
    look: "Forty moons at different spins, each a colour: how it stands and turns once in every revolution.",
    see: "Near one turn per revolution a moon sways about one face: closed curves, an island. The others turn on, curves from " +
         "edge to edge. Make the moon more oblong: islands grow, and between them the curves dissolve into chaos.",
    portrait: { problem: { id: "spin_orbit", epsilon: 0.0075 }, initial: { q: 0, p: 1 }, until: { t: 300 * tau },
                scheme: { id: "contact_leapfrog", step: tau / 40 }, section: { period: tau, phase: 0 }, columns: ["q_wrapped", "p"],
                keep: ["section"], members: { vary: { "/initial/p": { grid: [0.7, 1.7, 40] } } } },
    labels: ["angle", "spin"], key: ["spin at the start 0.7", "1.7"], control: { sets: "problem.epsilon", label: "how oblong, ε", low: 0.001, high: 0.1, log: true },
  },
  {
    id: "galaxy", title: "A star in a galaxy: order, and with a little more energy chaos",
    look: "Hénon and Heiles' star at twenty starts of the same energy, each a colour: where it is and how fast it goes, whenever it " +
          "crosses a plane. Begin with the energy 1/12.",
    see: "At 1/12 every star keeps to a curve of its own, as if there were a second law beside the energy. At 1/8 the curves between the " +
         "islands dissolve: one star's points fill what is left. At 1/6 hardly an island remains.",
    portrait: { problem: { id: "henon_heiles" }, until: { t: 1500 }, scheme: { id: "leapfrog", step: 0.1, composition: "suzuki_4" },
                section: { expression: "x", direction: "up" }, columns: ["y", "py"], keep: ["section"], surface: { energy: 1 / 12, starts: 10 } },
    labels: ["y", "momentum of y"], key: ["starts at rest, from the left", "starts at y = 0, ever faster"],
    control: { sets: "surface.energy", label: "energy", low: 0.02, high: 1 / 6 },
  },
  {
    id: "basins", title: "Which way a pendulum ends up turning can hang on the last digit of its start",
    look: "A pendulum with friction, driven hard, from 512 × 512 starts. Each is a pixel, coloured by how fast it turns after " +
          "forty strokes of the drive.",
    see: "Nearly all end in one of two motions, each the mirror image of the other: two colours. Their basins are folded into each " +
         "other so finely that near the boundary no start is known well enough.",
    portrait: { problem: { id: "custom", title: "Driven pendulum with friction", variables: ["q"], parameters: { a: 2, alpha: 0.2 },
                           potential: "-cos(q) - a*q*cos(t)", damping: "alpha", a: 2 },
                initial: { q: 0, p: 0 }, until: { t: 40 * tau }, scheme: { id: "contact_splitting", step: tau / 48 }, columns: ["p"],
                limits: { seconds: 60 }, keep: ["final"],
                members: { vary: { "/initial/q": { grid: [-Math.PI, Math.PI, 512] }, "/initial/p": { grid: [-2, 4, 512] } } } },
    labels: ["angle at the start", "velocity at the start"], key: ["velocity at the end"], control: { sets: "problem.a", label: "drive a", low: 1.8, high: 2.2 },
  },
  {
    id: "cosmos", group: "Other geometries", title: "Where H = 0, every orbit runs on one sphere, from pole to pole",
    look: "An oscillator in an expanding universe: place, momentum and action are a space of three. Drag it to turn it.",
    see: "The surface H = 0 is a sphere, and a contact scheme holds orbits on it, from the repelling pole below to the " +
         "attracting one above.",
    scene: { problem: { id: "cosmological_oscillator", gamma: 1, R: 1 }, until: { t: 20 } },
    runs: [{ ...h("contact_splitting", 0.02), initial: { q: 0.5, p: 0.3, s: -1.2884098726725126 } },
           { ...h("contact_splitting", 0.02), initial: { q: -0.05, p: 0, s: -1.4133294025102578 } },
           { ...h("explicit_euler", 0.1), initial: { q: 0.5, p: 0.3, s: -1.2884098726725126 } }],
    views: [{ x: "q", y: "p", z: "s", ball: Math.SQRT2 }, { x: "t", y: "energy" }], curve: true,
    control: { sets: "until.t", label: "until t", low: 2, high: 20 }, tells: [["H at the end", "trajectory.energy.last"]],
  },
  {
    id: "bath", title: "One long orbit can stand for a heat bath, or fail to",
    look: "How often a thermostatted oscillator is found at each place, over a long time, against the Gaussian it should give.",
    see: "With the narrow bath the orbit wanders everywhere and its histogram is the Gaussian; with the wide one it stays on " +
         "a torus, for ever.",
    scene: { problem: { id: "thermostat", beta: 1 }, until: { t: 20000 }, scheme: { id: "contact_splitting", step: 0.05 } },
    points: 40000,
    runs: [{ name: "narrow, scale 0.1", problem: { scale: 0.1 } }, { name: "wide, scale 1", problem: { scale: 1 } }],
    views: [{ x: "q", bins: [-4, 4, 40], labels: ["q", "density"],
              exact: [["Gaussian", (q, { beta }) => Math.sqrt(beta / tau) * Math.exp((-beta * q * q) / 2)]] }],
    control: { sets: "until.t", label: "until t", low: 200, high: 20000, log: true }, tells: [],
  },
  {
    id: "downhill", title: "Without inertia everything runs straight downhill, into one of two wells",
    look: "Six starts in a landscape with two wells, its lines of equal height in grey; the height along each path is drawn beside.",
    see: "The height falls along every path and never rises. Which well is reached is decided on the ridge between them.",
    scene: { problem: { id: "gradient_flow" }, until: { t: 12 }, scheme: { id: "contact_splitting", step: 0.05 } },
    runs: [[0.1, 1], [-1.6, 1.2], [1.6, 1], [-1.2, -1.2], [1, -1.3], [-0.2, 1.4]].map(([x, y]) => (
      { name: `from (${x}, ${y})`.replaceAll("-", "−"), initial: { x, y } })),
    views: [{ x: "x", y: "y", level: (x, y, { a, b, c }) => (a * (x * x - 1) ** 2) / 4 + (b * y * y) / 2 + c * x * y }, { x: "t", y: "potential" }],
    control: { sets: "problem.c", label: "tilt c", low: -0.9, high: 0.9 }, tells: [["ends at x", "final.x"]],
  },
  {
    id: "typed", title: "A scene is a line of text, and where it ends may hang on a hair",
    look: "A ball in a double well, with friction, typed as L = vx²/2 + x²/2 − x⁴/4 − α s. Three starts, a little apart.",
    see: "Friction takes the energy to cross the ridge; two end in one well, the third in the other. Another friction deals the " +
         "wells anew. Open it in the workbench and change the text.",
    scene: { problem: { id: "custom", title: "Double well with friction", variables: ["x"], parameters: { alpha: 0.1 },
                        lagrangian: "vx^2/2 + x^2/2 - x^4/4 - alpha*s", alpha: 0.1 },
             until: { t: 60 }, scheme: { id: "contact_splitting", step: 0.05, composition: "suzuki_4" } },
    runs: [{ name: "from 1.6", initial: { x: 1.6, px: 0 } }, { name: "from 2", initial: { x: 2, px: 0 } },
           { name: "from 2.2", initial: { x: 2.2, px: 0 } }],
    views: [{ x: "t", y: "x" }, { x: "x", y: "px" }], control: { sets: "problem.alpha", label: "friction α", low: 0.02, high: 0.5, log: true },
    tells: [["x at the end", "final.x"]],
  },
  {
    id: "heat", title: "Energy stays and entropy never falls: a scheme can respect both, or neither",
    look: "A mass on a spring whose friction warms its surroundings; long steps. Total energy on the left, entropy on the right.",
    see: "The splitting keeps the energy in bounds and lets entropy only rise; Euler makes energy out of nothing.",
    scene: { problem: { id: "generic_oscillator" }, until: { t: 50 } },
    runs: [h("contact_splitting", 0.2), h("explicit_euler", 0.2), h("explicit_midpoint", 0.4)],
    views: [{ x: "t", y: "energy", box: { y: [1.4, 2] } }, { x: "t", y: "entropy", box: { y: [0, 0.8] } }], control: steps(0.02, 0.5),
    tells: [["entropy gained", "diagnostics.entropy.final"]],
  },
  {
    id: "butterfly", title: "Weathers that differ by a millionth are soon strangers",
    look: "Lorenz's equations, three starts that differ by a millionth in x. Follow the curves over time.",
    see: "For a while they are one curve. The distance grows tenfold every 2.5 units of time, and then each goes its own way " +
         "on the same wings.",
    scene: { problem: { id: "lorenz" }, until: { t: 40 }, scheme: { id: "runge_kutta_4", step: 0.005 } },
    runs: [{ name: "x = 1", initial: { x: 1 } }, { name: "x = 1.000001", initial: { x: 1.000001 } },
           { name: "x = 1.000002", initial: { x: 1.000002 } }],
    views: [{ x: "x", y: "z" }, { x: "t", y: "x" }], one: { x: "t", y: "x" }, control: { sets: "problem.rho", label: "heating ρ", low: 0.5, high: 40 },
    tells: [["x at the end", "final.x"]],
  },
  {
    id: "digits", group: "The price of a digit", title: "What a digit costs depends on how many you want",
    look: "Kepler's ellipse over ten revolutions: the error against the number of force evaluations, each point a run made now.",
    see: "For two digits it is cheapest to slow time down near the sun; for more, to raise the order. Each further digit " +
         "costs leapfrog three times as much, a scheme of order 8 a third more.",
    study: { problem: { id: "kepler" }, initial: { x: 0.4, y: 0, px: 0, py: 2 }, until: { t: 20 * Math.PI }, error: "max",
             schemes: ["leapfrog", { id: "leapfrog", composition: "suzuki_4" }, { id: "leapfrog", composition: "kahan_li_8" },
                       "runge_kutta_4", "time_transformed"], budget_seconds: 2 },
  },
];
