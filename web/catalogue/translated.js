// The catalogue in the language that is spoken: what has no text in it stays as the service says it.
import { known } from "../language/texts.js";

/** What is said of a parameter or a variable, under the service's own words: many cards say the same. */
function said(doc) {
  const [, of] = /^momentum of (.+)$/.exec(doc) ?? [], one = of ? doc.slice(0, -of.length) + "{x}" : doc;
  return known(`doc.${doc}`) ?? known(`doc.${one}`)?.replace("{x}", of) ?? doc;
}
const documented = (cards) => cards?.map((card) => ({ ...card, doc: said(card.doc) }));

/** Cards of a `kind`, with the texts of theirs by name, and of their presets, in the place of the service's. */
const spoken = (kind, cards, names) => cards.map((card) => {
  const of = (name, usual) => known(`${kind}.${card.id}.${name}`) ?? usual;
  return { ...card, ...Object.fromEntries(names.map((name) => [name, of(name, card[name])])),
           presets: card.presets.map((preset) => ({ ...preset, doc: of(preset.name, preset.doc) })),
           parameters: documented(card.parameters), variables: documented(card.variables) };
});

export const translated = ({ problems, schemes, ...rest }) => ({
  ...rest, problems: spoken("problem", problems, ["title", "summary"]),
  schemes: spoken("scheme", schemes, ["title", "summary", "good_for", "fails_when"]) });
