// The catalogue in the language that is spoken: what has no text in it stays as the service says it.
import { known } from "../language/texts.js";

/** Cards of a `kind`, the texts of theirs by name in the place of the service's. */
const spoken = (kind, cards, names) => cards.map((card) => (
  { ...card, ...Object.fromEntries(names.map((name) => [name, known(`${kind}.${card.id}.${name}`) ?? card[name]])) }));

export const translated = ({ problems, schemes, ...rest }) => ({
  ...rest, problems: spoken("problem", problems, ["title", "summary"]),
  schemes: spoken("scheme", schemes, ["title", "summary", "good_for", "fails_when"]) });
