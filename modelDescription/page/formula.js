// Parses a formula, in the infix form of algebra/formula.h, into a tree with estimated widths, by recursive descent for the grammar
//
//     sum = ["-"] product {("+" | "-") product}      power = primary ["^" ["-"] primary]
//     product = power {("*" | "/") power}            argument = sum [">" sum]
//     primary = number | name ["(" argument {"," argument} ")"] | "(" sum ")" | "..."
//
// where "..." stands for omitted terms. A node has a kind, a word (of a number, a name or a function) and parts: two or more of sums and
// products, two of fractions, powers and conditions. Reads each character once; the recursion is as deep as the parentheses.

const NAME = /[A-Za-z_](?:\w|\.(?!\.)|\[[^\]]*\])*/g;
const TOKEN = new RegExp(`\\s*(\\.\\.\\.|\\d+(?:\\.\\d+)?(?:e[-+]?\\d+)?|${NAME.source}|\\S)`, "y");

// Returns the tokens of a text in reverse order, so that pop() takes the next one.
function tokensOf(text) {
  TOKEN.lastIndex = 0;
  const tokens = [];
  for (let found; (found = TOKEN.exec(text)); ) tokens.push(found[1]);
  return tokens.reverse();
}

const isName = token => /^[A-Za-z_]/.test(token);

class Parser {
  constructor(text) {
    this.tokens = tokensOf(text);
  }

  get next() {
    return this.tokens.at(-1) ?? "";
  }

  take(token) {
    return this.next === token && this.tokens.pop() !== undefined;
  }

  demand(token) {
    if (!this.take(token)) throw new SyntaxError(`expected ${token} before ${this.next}`);
  }

  sum() {
    let whole = this.take("-") ? node("negative", this.product()) : this.product();
    for (;;) {
      if (this.take("+") || this.next === "...") whole = joined("sum", whole, this.product());
      else if (this.take("-")) whole = joined("sum", whole, node("negative", this.product()));
      else return whole;
    }
  }

  product() {
    let whole = this.power();
    for (;;) {
      if (this.take("*")) whole = joined("product", whole, this.power());
      else if (this.take("/")) whole = node("fraction", whole, this.power());
      else return whole;
    }
  }

  power() {
    const base = this.primary();
    if (!this.take("^")) return base;
    return node("power", base, this.take("-") ? node("negative", this.primary()) : this.primary());
  }

  primary() {
    const token = this.tokens.pop() ?? "";
    if (token === "...") return node("ellipsis");
    if (/^\d/.test(token)) return { ...node("number"), word: token };
    if (isName(token)) return this.next === "(" ? this.call(token) : { ...node("name"), word: token };
    if (token !== "(") throw new SyntaxError(`unexpected ${token}`);
    const inside = this.sum();
    this.demand(")");
    return inside;
  }

  call(word) {
    const parts = [];
    this.demand("(");
    do parts.push(this.argument());
    while (this.take(","));
    this.demand(")");
    return { ...node("call", ...parts), word };
  }

  argument() {
    const left = this.sum();
    return this.take(">") ? node("condition", left, this.sum()) : left;
  }
}

const node = (kind, ...parts) => ({ kind, parts });

// Returns the sum or product with a further part; the factors of a product in parentheses join it.
function joined(kind, whole, part) {
  const parts = kind === "product" && part.kind === kind ? part.parts : [part];
  return node(kind, ...(whole.kind === kind ? whole.parts : [whole]), ...parts);
}

// True for if(condition, value, other).
const isChoice = ({ kind, word, parts }) => kind === "call" && word === "if" && parts.length === 3;

const WIDTHS = {
  number: ({ word }) => word.length,
  name: ({ word }) => widthOfName(word),
  ellipsis: () => 2,
  call: (formula, widths) => (isChoice(formula) ? widths[0] + Math.max(widths[1], widths[2]) + 4 : formula.word.length + 1 + sumOf(widths) + widths.length),
  condition: (_, widths) => sumOf(widths) + 3,
  sum: (_, widths) => sumOf(widths) + 2 * widths.length, // with parentheses
  negative: (_, widths) => widths[0] + 1,
  product: (_, widths) => sumOf(widths) + 0.3 * (widths.length - 1),
  fraction: (_, widths) => Math.max(...widths) + 0.5,
  power: (_, widths) => widths[0] + 0.7 * widths[1] + 1,
};

const sumOf = widths => widths.reduce((sum, width) => sum + width, 0);

// Estimates the widths of a formula and its parts in letters; signs with their spaces, and parentheses, count as letters.
function measured(formula) {
  formula.parts.forEach(measured);
  formula.width = WIDTHS[formula.kind](formula, formula.parts.map(({ width }) => width));
  formula.isTall = formula.kind === "fraction" || isChoice(formula) || formula.parts.some(({ isTall }) => isTall);
  return formula;
}

// Returns the trees of the sides of an equation, or of one expression; throws a SyntaxError for other texts.
function parsed(text) {
  return text.split(" = ").map(side => {
    const parser = new Parser(side), formula = parser.sum();
    if (parser.next !== "") throw new SyntaxError(`unexpected ${parser.next}`);
    return measured(formula);
  });
}
