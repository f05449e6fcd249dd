// Typesets formulas as MathML, which browsers show without a library.
//
// Browsers do not break lines inside <math>, so that a wide formula becomes several <math> elements with <wbr> between them. A part up to
// NARROW letters wide is set as a whole (set); a wider one is split at its operator, and its operands likewise (setInPieces). Wide fractions
// and powers are rewritten on one line, as a <math> element cannot contain a break. Each node is visited once.

const MATH = '<math display="inline" displaystyle="true">', BREAK = `</math><wbr/>${MATH}`;
const NARROW = 20; // letters of a part without breaks, which fits on a phone
const NARROW_CASES = 28; // the same for cases, which would become if(c, a, b)
const LONGEST = 3000; // characters of an equation; longer ones stay texts

const GREEK = Object.fromEntries(
  ("alpha α beta β gamma γ delta δ epsilon ε zeta ζ eta η theta θ kappa κ lambda λ mu μ nu ν xi ξ pi π rho ρ sigma σ tau τ phi φ chi χ psi ψ " +
    "omega ω Gamma Γ Delta Δ Theta Θ Lambda Λ Xi Ξ Pi Π Sigma Σ Phi Φ Psi Ψ Omega Ω").match(/\w+ \S/g).map(pair => pair.split(" ")),
);
const UPRIGHT = new Set(["sin", "cos", "tan", "sinh", "cosh", "tanh"]); // functions of a name without parentheses
const DOTS = ["", "˙", "¨"];
const THIN = '<mspace width="0.17em"></mspace>', APPLIED = "<mo>&#x2061;</mo>";

// * Splits a name into a base and its indices: theta1, theta[1] and omegaCoupler become Greek letters with an index, and x_end gets one too. The
// part of the system that a name belongs to is the last index, and loop.force is F with the constraint's name.
function symbolOf(name) {
  const [, part, last] = name.match(/^(?:(.*)\.)?([^.]*)$/), [word, bracket] = last.split(/[[\]]/);
  const [, stem, digits] = bracket === undefined && !/(^|_)\d+$/.test(word) ? word.match(/^(.*?)(\d*)$/) : [, word, ""];
  const camel = stem.match(/^([A-Za-z]+?)([A-Z].*)$/), snake = stem.match(/^(.[^_]*)_(.+)$/);
  const [, base, index] = (camel && camel[1] in GREEK && camel) || snake || [stem, stem];
  return { base: part && last === "force" ? "F" : base, indices: [index, digits, bracket, part].filter(Boolean) };
}

function widthOfName(name) {
  const { base, indices } = symbolOf(name);
  return (base in GREEK ? 1 : base.length) + 0.7 * indices.join("").length;
}

// Typesets a name with 0, 1 or 2 dots for time derivatives; with an exponent above its indices, if it has any.
function setName(name, dots = 0, exponent = "") {
  const { base, indices } = symbolOf(name), letter = `<mi>${GREEK[base] ?? base}</mi>`;
  const dotted = dots ? `<mover accent="true">${letter}<mo>${DOTS[dots]}</mo></mover>` : letter;
  if (indices.length === 0) return dotted;
  const index = text => (/^\d/.test(text) ? `<mn>${text}</mn>` : `<mtext>${text}</mtext>`);
  const row = `<mrow>${indices.map(index).join("<mo>,</mo>")}</mrow>`;
  return exponent ? `<msubsup>${dotted}${row}<mrow>${exponent}</mrow></msubsup>` : `<msub>${dotted}${row}</msub>`;
}

// * Returns the ratio that a number with at least 14 characters stands for, as integrals give them: a multiple of 1/3 .. 1/45 to 1e-13. Returns
// undefined for other numbers.
function ratioOf(word) {
  if (word.length < 14 || word.includes("e")) return undefined;
  for (let below = 3; below <= 45; below++) {
    const product = word * below, above = Math.round(product);
    if (above >= 1 && Math.abs(product - above) <= 1e-13 * above) return `<mfrac><mn>${above}</mn><mn>${below}</mn></mfrac>`;
  }
  return undefined;
}

// Typesets 4e-05 as 4 times a power of ten.
function setNumber(word) {
  const [mantissa, exponent] = word.split("e"), sign = exponent < 0 ? "<mo>−</mo>" : "";
  const power = exponent && `<mo>⋅</mo><msup><mn>10</mn><mrow>${sign}<mn>${Math.abs(exponent)}</mn></mrow></msup>`;
  return ratioOf(word) ?? `<mn>${mantissa}</mn>${power ?? ""}`;
}

// True if a formula needs no parentheses as a factor or term, and as the base of a power.
const standsAsFactor = ({ kind }) => !["sum", "negative", "condition"].includes(kind);
const standsAsBase = ({ kind }) => ["number", "name", "call", "ellipsis"].includes(kind);

// True for sin²(...).
const isPowerOfFunction = ({ kind, parts }) => kind === "power" && parts[1].kind === "number" && parts[0].kind === "call" && UPRIGHT.has(parts[0].word);

// True for sin x and sin² x, whose argument is a name.
function standsBare(formula) {
  const { kind, word, parts } = isPowerOfFunction(formula) ? formula.parts[0] : formula;
  return kind === "call" && parts.length === 1 && parts[0].kind === "name" && UPRIGHT.has(word);
}

// A parenthesis has a fixed height, as its counterpart may be in another <math> element.
function parenthesis(text, isTall) {
  const size = isTall ? 'minsize="2.2em" maxsize="2.2em"' : 'stretchy="false"';
  return `<mo form="${text === "(" ? "prefix" : "postfix"}" ${size}>${text}</mo>`;
}

const inParentheses = (content, isTall) => parenthesis("(", isTall) + content + parenthesis(")", isTall);

// Returns the formula by a typesetting function, in parentheses unless it stands without.
const fenced = (formula, stands, by) => (stands(formula) ? by(formula) : inParentheses(by(formula), formula.isTall));

const setFunction = word => `<mi mathvariant="normal">${word}</mi>`;

// Returns the sign before a term, and the term without it.
function signed(term, isFirst) {
  if (term.kind === "negative") return [`<mo form="${isFirst ? "prefix" : "infix"}">−</mo>`, term.parts[0]];
  return [isFirst || term.kind === "ellipsis" ? "" : '<mo form="infix">+</mo>', term];
}

// Returns the operator before a factor: a thin space, or a dot before a number.
function timesBefore(factor) {
  while (["power", "product", "fraction"].includes(factor.kind)) factor = factor.parts[0];
  return factor.kind === "number" ? "<mo>⋅</mo>" : `<mo>&#x2062;</mo>${THIN}`;
}

// Typesets the cases of if(c, a, if(d, b, e)), one in each row, with a brace before them.
function setCases(formula) {
  const rows = [];
  for (; isChoice(formula); formula = formula.parts[2])
    rows.push(`<mtr><mtd>${set(formula.parts[1])}</mtd><mtd><mtext>if&#xa0;</mtext>${set(formula.parts[0])}</mtd></mtr>`);
  rows.push(`<mtr><mtd>${set(formula)}</mtd><mtd><mtext>else</mtext></mtd></mtr>`);
  return `<mrow><mo form="prefix" stretchy="true">{</mo><mtable>${rows.join("")}</mtable></mrow>`;
}

const setArguments = parts => parts.map(set).join("<mo>,</mo>");
const argumentsOf = ({ parts, isTall }) => inParentheses(setArguments(parts), isTall);

// Typesets der(x) and der(der(x)) with dots, and other time derivatives as d/dt.
function setDerivative({ parts: [inside] }) {
  const [name, dots] = inside.word === "der" ? [inside.parts[0], 2] : [inside, 1];
  if (name.kind === "name") return setName(name.word, dots);
  const d = setFunction("d");
  return `<mfrac>${d}<mrow>${d}<mi>t</mi></mrow></mfrac>${fenced(inside, standsAsFactor, set)}`;
}

const CALLS = {
  der: setDerivative,
  diff: ({ parts: [of, by] }) => `<mfrac><mrow><mo>∂</mo>${set(of)}</mrow><mrow><mo>∂</mo>${set(by)}</mrow></mfrac>`,
  sqrt: ({ parts }) => `<msqrt>${setArguments(parts)}</msqrt>`,
  abs: ({ parts }) => `<mrow><mo>|</mo>${setArguments(parts)}<mo>|</mo></mrow>`,
};

function setCall(formula) {
  if (isChoice(formula)) return setCases(formula);
  if (Object.hasOwn(CALLS, formula.word)) return CALLS[formula.word](formula);
  return setFunctionOf(formula, argumentsOf);
}

// Typesets a function, or a power of one, with its argument by a typesetting function.
function setFunctionOf(formula, argument) {
  const call = formula.kind === "power" ? formula.parts[0] : formula, word = setFunction(call.word);
  const head = call === formula ? word : `<msup>${word}${set(formula.parts[1])}</msup>`;
  return `<mrow>${head}${APPLIED}${argument(call)}</mrow>`;
}

const setBare = formula => setFunctionOf(formula, call => THIN + set(call.parts[0]));

function setPower(formula) {
  const [base, exponent] = formula.parts;
  if (isPowerOfFunction(formula)) return setFunctionOf(formula, argumentsOf);
  if (base.kind === "name" && symbolOf(base.word).indices.length > 0) return setName(base.word, 0, set(exponent));
  return `<msup><mrow>${fenced(base, standsAsBase, set)}</mrow><mrow>${set(exponent)}</mrow></msup>`;
}

// Typesets a factor of a product; only trailing functions stand without parentheses, as other factors must not follow these.
function setFactor(factors, i) {
  const factor = factors[i];
  if (factors.slice(i).every(standsBare)) return setBare(factor);
  if (factor.kind === "call") return setCall(factor);
  return factor.kind === "power" ? setPower(factor) : fenced(factor, standsAsFactor, set);
}

function setTerm(term, i) {
  const [sign, inside] = signed(term, i === 0);
  return sign + fenced(inside, standsAsFactor, set);
}

const SETTERS = {
  number: ({ word }) => setNumber(word),
  name: ({ word }) => setName(word),
  ellipsis: () => "<mo>…</mo>",
  call: setCall,
  condition: ({ parts }) => parts.map(set).join("<mo>&gt;</mo>"),
  sum: ({ parts }) => parts.map(setTerm).join(""),
  negative: formula => setTerm(formula, 0),
  product: ({ parts }) => parts.map((factor, i) => (i > 0 ? timesBefore(factor) : "") + setFactor(parts, i)).join(""),
  fraction: ({ parts: [above, below] }) => `<mfrac><mrow>${set(above)}</mrow><mrow>${set(below)}</mrow></mfrac>`,
  power: setPower,
};

// Returns the content of a <math> element.
const set = formula => (standsBare(formula) ? setBare(formula) : SETTERS[formula.kind](formula));

const isNarrow = formula => formula.width <= (isChoice(formula) ? NARROW_CASES : NARROW);

function setTermInPieces(term, i) {
  const [sign, inside] = signed(term, i === 0);
  return (i > 0 ? BREAK : "") + sign + fenced(inside, standsAsFactor, setInPieces);
}

function setProductInPieces({ parts }) {
  let width = 0; // of the present <math> element
  const pieces = parts.map((factor, i) => {
    const breaks = i > 0 && width + factor.width > NARROW;
    width = (breaks ? 0 : width) + factor.width;
    const set = isNarrow(factor) ? setFactor(parts, i) : fenced(factor, standsAsFactor, setInPieces);
    return (i > 0 ? timesBefore(factor) : "") + (breaks ? BREAK : "") + set;
  });
  return pieces.join("");
}

// Typesets a wide numerator after the fraction, and a wide denominator after a slash.
function setFractionInPieces({ parts: [above, below] }) {
  const wide = fenced(above, standsAsFactor, setInPieces);
  if (below.width > NARROW) return `${wide}${BREAK}<mo form="infix">/</mo>${fenced(below, standsAsBase, setInPieces)}`;
  return `<mfrac><mn>1</mn><mrow>${set(below)}</mrow></mfrac>${timesBefore(above)}${below.kind === "number" ? "" : BREAK}${wide}`;
}

const setCallInPieces = (word, { parts, isTall }) => setFunction(word) + inParentheses(parts.map(setInPieces).join(`<mo>,</mo>${BREAK}`), isTall);

function setPowerInPieces(formula) {
  const [base, exponent] = formula.parts;
  if (exponent.width > NARROW / 2) return setCallInPieces("pow", formula);
  const end = `<msup>${parenthesis(")", base.isTall)}<mrow>${set(exponent)}</mrow></msup>`;
  return parenthesis("(", base.isTall) + setInPieces(base) + end;
}

const PIECE_SETTERS = {
  ...SETTERS,
  name: ({ word }) => word.match(new RegExp(`.{1,${NARROW}}`, "g")).map(part => `<mi>${part}</mi>`).join(BREAK),
  call: formula => setCallInPieces(formula.word, formula),
  condition: ({ parts }) => parts.map(setInPieces).join("<mo>&gt;</mo>"),
  sum: ({ parts }) => parts.map(setTermInPieces).join(""),
  negative: formula => setTermInPieces(formula, 0),
  product: setProductInPieces,
  fraction: setFractionInPieces,
  power: setPowerInPieces,
};

const setInPieces = formula => (isNarrow(formula) ? set(formula) : PIECE_SETTERS[formula.kind](formula));

// Returns an equation, or an expression, as MathML between whose elements lines may break; null if it is too long or has another form.
function mathmlOf(text) {
  if (text.length > LONGEST) return null;
  try {
    return MATH + parsed(text).map(setInPieces).join(`${BREAK}<mo form="infix">=</mo>`) + "</math>";
  } catch (error) {
    if (error instanceof SyntaxError) return null;
    throw error;
  }
}
