// The experiment as the part of the address behind `#`, and back: `problem=kepler&problem.mu=1&initial.x=0&A=leapfrog…`.
// An experiment has the sections of a request, with the two schemes under the names of the runs:
// {problem: {id, …}, preset: {id}, initial: {…}, until: {t}, record: {samples}, axes: {x, y}, A: {id, …}, B: {id, …}}.

export function toHash(experiment) {
  const pairs = new URLSearchParams();
  for (const [section, values] of Object.entries(experiment)) {
    for (const [name, value] of Object.entries(values)) {
      pairs.append(name === "id" ? section : `${section}.${name}`, value === null ? "" : String(value));
    }
  }
  return `#${pairs}`;
}

/** Values come back as text; the fields they go to know what they are. */
export function fromHash(hash) {
  const experiment = {};
  for (const [key, value] of new URLSearchParams(hash.replace(/^#/, ""))) {
    const [section, name = "id"] = key.split(".");
    (experiment[section] ??= {})[name] = value;
  }
  return experiment;
}
