// Formulas in answers of the service, rebuilt from known elements and attributes only, so that nothing else gets into the page.

const elements = ["math", "mrow", "mi", "mn", "mo", "mtext", "mspace", "mfrac", "msqrt", "mroot", "msup", "msub", "msubsup",
                  "mover", "munder", "munderover", "mtable", "mtr", "mtd", "mstyle", "mpadded", "mphantom"];
const attributes = ["mathvariant", "width", "stretchy", "fence", "separator", "accent", "columnalign", "displaystyle", "linethickness",
                    "lspace", "rspace"];
const made = (name) => document.createElementNS("http://www.w3.org/1998/Math/MathML", name);

const greek = new Map(("alpha α,beta β,gamma γ,delta δ,epsilon ε,zeta ζ,eta η,theta θ,kappa κ,lambda λ,mu μ,nu ν,xi ξ,rho ρ," +
  "sigma σ,tau τ,phi φ,chi χ,psi ψ,omega ω,Gamma Γ,Delta Δ,Theta Θ,Lambda Λ,Phi Φ,Psi Ψ,Omega Ω").split(",").map((pair) => pair.split(" ")));

/** A name that is typed, as it is written: `gamma` γ, `q1` with an index, `px`, `vtheta` and `ptheta1` with their coordinate for one. */
function written(name) {
  if (greek.has(name)) return [greek.get(name)];
  const [, of, angle, digits] = /^([pv])([A-Za-z]+?)_?(\d+)$/.exec(name) ?? [];
  if (greek.has(angle)) return [of, greek.get(angle) + digits];
  const [, letter = name, index] = /^([A-Za-z]+?)_?(\d+)$/.exec(name) ?? /^([pv])([A-Za-z])$/.exec(name) ??
    (greek.has(name.slice(1)) ? /^([pv])(.+)$/.exec(name) : null) ?? [];
  return [letter, ...(index ? [index] : [])].map((part) => greek.get(part) ?? part);
}

function identifier(name) {
  const [letter, index] = written(name).map((textContent) => Object.assign(made("mi"), { textContent }));
  if (!index) return letter;
  const both = made("msub");
  both.append(letter, index);
  return both;
}

/** A copy of a node; an element that is not one of formulas is replaced by its text. */
function copy(node) {
  if (node.nodeType !== Node.ELEMENT_NODE) return document.createTextNode(node.nodeType === Node.TEXT_NODE ? node.data : "");
  const children = [...node.childNodes].map(copy);
  if (!elements.includes(node.localName)) return document.createTextNode(children.map((child) => child.textContent).join(""));
  if (node.localName === "mi" && /^\w{2,}$/.test(node.textContent)) return identifier(node.textContent);
  const one = made(node.localName);
  if (node.textContent === "\u2062") one.setAttribute("lspace", "0.12em"); // a product without a sign
  for (const name of attributes) if (node.hasAttribute(name)) one.setAttribute(name, node.getAttribute(name));
  one.append(...children);
  return one;
}

/** The terms of a row and of the rows in it, between which lines may break; brackets with their contents are one term. */
const terms = (row) => [...row.childNodes].flatMap((part) =>
  (part.localName === "mrow" && !["(", "|"].includes(part.firstChild?.textContent) ? terms(part) : [part]));

const parsed = (text) => new DOMParser().parseFromString(text, "application/xml").querySelector("math");

/** A formula with a line for each equation, so that none is cut off; a `typed` one may break between all its terms. */
export function formulaOf(text, typed = false) {
  const math = parsed(text);
  return math ? inLines(typed ? terms(math) : math.childNodes, typed) : [];
}

/** Equations of a table, each in as many lines as it needs. */
export const equationsOf = (text) => [...(parsed(text)?.querySelectorAll("mtr") ?? [])].map((row) => inLines([...row.childNodes].flatMap(terms), true));

function inLines(parts, typed) {
  const lines = [[]];
  for (const part of parts) {
    const said = part.textContent, long = lines.at(-1).reduce((n, { textContent }) => n + textContent.length, 0) > (typed ? 14 : 10);
    const sum = part.localName === "mo" && ["+", "−"].includes(said) && long;
    if (sum) lines.push([]);
    if (part.localName === "mo" && said === ",") lines.push([]);
    else lines.at(-1).push(part);
  }
  return lines.filter((line) => line.length).map((line) => {
    const one = made("math");
    one.setAttribute("display", "block");
    one.append(...line.map(copy));
    return one;
  });
}
