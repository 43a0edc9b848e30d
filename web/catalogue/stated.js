// What a scene as text states of its pictures: `views`, columns drawn together, and `bodies`, what moves and what links it.

/** Entries of views and bodies that are neither columns of the scene nor numbers, as columns of their own: `[{name, expression}]`. */
export function statedColumns({ views = [], bodies = [], columns = [] }) {
  const entries = new Set([...views.flat(), ...bodies.flatMap(({ at }) => at)]);
  const own = [...entries].filter((entry) => !columns.includes(entry) && !entry.endsWith("[*]") && !Number.isFinite(Number(entry)));
  return own.slice(0, 90).map((expression, i) => ({ name: `drawn_${i + 1}`, expression }));
}

/** Returns a function from an entry to its column of a trajectory, or to a kind of columns. */
const columnOf = (problem) => {
  const own = new Map(statedColumns(problem).map(({ name, expression }) => [expression, name]));
  return (entry) => (entry.endsWith("[*]") ? `${entry.slice(0, -3)}*` : own.get(entry) ?? entry);
};

/** The axes of the views of a scene. */
export const statedViews = (problem) => (problem.views ?? []).map((view) => view.map(columnOf(problem)));
/** Its bodies, the places in columns; null where it states none. */
export const statedBodies = (problem) => problem.bodies?.map(({ at, ...body }) => ({ ...body, at: at.map(columnOf(problem)) })) ?? null;
