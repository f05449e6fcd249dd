// Reads the text of a system while it is written: its tokens, for colors, and the completions at a position.
"use strict";

const FUNCTIONS = "abs acos acosh asin asinh atan atan2 atanh ceil cos cosh der diff distance dot exp floor gauss if integral log max min mod norm pow round sign sin sinh sqrt sum tan tanh uniform".split(" ");
const OPERATORS = ["and", "not", "or"];
const OUTSIDE = /<!--[^]*?(?:-->|$)|<[?!][^]*?(?:>|$)|<\/?[\w:.-]*|[^<]+/y; // a comment, a declaration, the begin of a tag, or text
const INSIDE = /\/?>|"[^"]*(?:"|$)|'[^']*(?:'|$)|[\w:.-]+|\s+|[^]/y; // the end of a tag, a value, the name of an attribute, or blanks

// Returns the tokens of a text as [kind, begin, end], which follow each other without gaps, although the text may not be XML yet.
function tokensOf(text) {
  const tokens = [];
  for (let at = 0, inTag = false; at < text.length; ) {
    const rule = inTag ? INSIDE : OUTSIDE;
    rule.lastIndex = at;
    const [word] = rule.exec(text), first = word[0];
    let kind = "text";
    if (!inTag) {
      kind = /^<[?!]/.test(word) ? "comment" : first === "<" ? "tag" : "text";
      inTag = kind === "tag";
    } else if (/^\/?>$/.test(word)) {
      kind = "tag";
      inTag = false;
    } else if (first === '"' || first === "'") kind = "value";
    else if (/^[\w:.-]/.test(word)) kind = "attribute";
    tokens.push([kind, at, (at += word.length)]);
  }
  return tokens;
}

// Returns the text as HTML in which each token has its kind as a class. Parts in the ranges of mistakes, [begin, end] each, have the class "wrong", too.
function highlighted(text, mistakes = []) {
  const escape = (part) => part.replace(/&/g, "&amp;").replace(/</g, "&lt;"), ends = mistakes.flat().sort((a, b) => a - b);
  const partsOf = ([kind, begin, end]) => {
    const cuts = [begin, ...ends.filter((at) => begin < at && at < end), end];
    return cuts.slice(1).map((to, i) => [mistakes.some(([from, after]) => from <= cuts[i] && to <= after) ? `${kind} wrong` : kind, escape(text.slice(cuts[i], to))]);
  };
  return tokensOf(text).flatMap(partsOf).map(([kind, part]) => (kind === "text" ? part : `<span class="${kind}">${part}</span>`)).join("");
}

// Returns the attributes of a tag from some of its tokens on.
function attributesFrom(text, tokens) {
  const end = tokens.findIndex(([kind]) => kind === "tag");
  return tokens.slice(0, end < 0 ? undefined : end).filter(([kind]) => kind === "attribute").map(([, begin, after]) => text.slice(begin, after));
}

// Returns the context of a position: its kind, the part of the word before it, and the attribute before it. It also has the element, its parent, and
// its attributes without the one at the position.
function contextAt(text, at) {
  const open = [], tokens = tokensOf(text);
  let element = "", attributes = [];
  for (const [i, [kind, begin, end]] of tokens.entries()) {
    const word = text.slice(begin, end), here = { word: text.slice(begin, at), element, parent: open.at(-1) ?? "", attributes, attribute: attributes.at(-1) ?? "" };
    const isHere = begin < at && at <= end;
    if (kind === "tag" && word[0] === "<") {
      if (isHere) return { ...here, kind: word[1] === "/" ? "end" : "element", word: here.word.replace(/^<\/?/, "") };
      if (word[1] === "/") open.pop();
      else [element, attributes] = [word.slice(1), []];
    } else if (kind === "tag") {
      if (isHere && at < end) return { ...here, kind: "none" };
      if (word === ">" && element) open.push(element);
      element = "";
    } else if (kind === "attribute") {
      if (isHere) return { ...here, kind, attributes: [...attributes, ...attributesFrom(text, tokens.slice(i + 1))] };
      attributes = [...attributes, word];
    } else if (kind === "value" && isHere && (at < end || !/^(["']).*\1$/s.test(word))) return { ...here, kind, word: /[\w.]*$/.exec(here.word)[0] };
    else if (kind === "text" && isHere) return element ? { ...here, kind: "attribute", word: "", attributes: [...attributes, ...attributesFrom(text, tokens.slice(i + 1))] } : { ...here, kind, word: /[\w.]*$/.exec(here.word)[0] };
  }
  return { kind: "text", word: "", element: "", parent: open.at(-1) ?? "", attributes: [], attribute: "" };
}

// Returns the kind of an element that stands in a parent. Some elements mean different things in different parents.
const kindOf = (language, element, parent) => language[element]?.find(({ in: parents }) => parents.includes(parent)) ?? language[element]?.[0];

// Returns the names that expressions of a text may use.
function namesIn(text) {
  const found = [...text.matchAll(/\b(?:name|velocity)\s*=\s*["']([A-Za-z_]\w*)["']/g)].map((match) => match[1]);
  return [...new Set([...found.sort(), ...FUNCTIONS.map((name) => `${name}(`), ...OPERATORS, "pi", "time"])];
}

// Attributes that are not required, but that most elements of this name have.
const USUAL = { particle: ["name", "x", "y"], body: ["name", "x", "y", "inertia", "angle"], point: ["x", "y"], line: ["to"], force: ["coordinate"], spring: ["stiffness", "length"], stop: ["min"], parameter: ["start"], mode: ["start"] };

// Returns the text of a new element; "|" marks the position of the caret.
function elementText(name, { attributes, contains, hasText }) {
  const required = Object.entries(attributes).filter(([attribute, { isRequired }]) => isRequired || USUAL[name]?.includes(attribute)).map(([attribute]) => ` ${attribute}=""`).join("");
  const text = `${name}${required}${contains.length || hasText ? `></${name}>` : "/>"}`;
  return required ? text.replace('""', '"|"') : text.replace(/><\/|\/>/, (end) => (end === "/>" ? "|/>" : ">|</"));
}

// Returns the word before a position and its completions, each as {label, text, note}, where text replaces the part of the word that is there.
function completionsAt(text, at, language) {
  const { kind, word, element, parent, attributes, attribute } = contextAt(text, at);
  const begins = ({ label }) => label.toLowerCase().startsWith(word.toLowerCase());
  let completions = [];
  if (kind === "element") {
    completions = Object.keys(language).map((name) => [name, kindOf(language, name, parent)]).filter(([, { in: parents }]) => (parent ? parents.includes(parent) : parents.length === 0))
      .map(([name, declaration]) => ({ label: name, text: elementText(name, declaration), note: declaration.text }));
  } else if (kind === "end") completions = parent ? [{ label: parent, text: `${parent}>`, note: "" }] : [];
  else if (kind === "attribute") {
    completions = Object.entries(kindOf(language, element, parent)?.attributes ?? {}).filter(([name]) => !attributes.includes(name)).map(([name, { text: note }]) => ({ label: name, text: `${name}="|"`, note }));
  } else if (kind === "value" || (kind === "text" && parent)) {
    const values = kind === "value" ? (kindOf(language, element, parent)?.attributes[attribute]?.values ?? []) : [];
    const free = kind === "text" || !["name", "velocity", "description", "unit", "displayUnit"].includes(attribute);
    completions = values.length > 0 ? values.map((value) => ({ label: value, text: value, note: "" })) : free && word ? namesIn(text).map((name) => ({ label: name, text: name, note: "" })) : [];
  }
  const found = completions.filter(begins);
  return { word, completions: found.length === 1 && found[0].label === word ? [] : found };
}
