// Converts LaTeX of latex.c to MathML, which browsers show without a library, by recursive descent.
//
// Browsers do not break lines inside <math>, so that a wide formula becomes several <math> elements with <wbr> between them. Each part has a
// form on one line, and one in pieces: its signs, factors and arguments may begin lines. Wide fractions, powers, roots and cases are rewritten
// in pieces, as a <math> element cannot contain a break. Reads each character once.

const MATH = '<math display="inline" displaystyle="true">', BREAK = `</math><wbr/>${MATH}`;
const NARROW = Math.max(20, Math.min(48, innerWidth / 28)); // letters of a part without breaks: 20 fit on a phone
const STILL_NARROW = NARROW + 8; // the same for roots and cases, which would become sqrt(a) and if(c, a, b)

const FUNCTION = /^(?:(?:sin|cos|tan)h?|log|exp|min|max)$/; // other commands without arguments are Greek letters
const DOTS = { "\\dot": "˙", "\\ddot": "¨" };
const TOKEN = /\\(?:left|right).|\\[A-Za-z]+|\\.|\d+(?:\.\d+)?|\S/g;

const THIN = '<mspace width="0.17em"></mspace>';
const TIMES = { "\\,": `<mo>&#x2062;</mo>${THIN}`, "\\cdot": "<mo>⋅</mo>" };
const infix = text => `<mo form="infix">${text}</mo>`;
const SIGNS = { "+": infix("+"), "-": infix("−"), "=": infix("="), ">": "<mo>&gt;</mo>", ",": "<mo>,</mo>" };
const MINUS = '<mo form="prefix">−</mo>'; // of a first term
const ENDS = new Set([undefined, "}", ")", "\\right)", "\\right|", "&", "\\\\", "\\end"]);

// A part with its MathML on one line, its width in letters, and its MathML in pieces, which a narrow part does not have.
const part = (html, width, wide = html, limit = NARROW) => ({ html, width, pieces: width <= limit ? html : wide });

const sumOf = numbers => numbers.reduce((sum, number) => sum + number, 0);
const slices = html => html.replace(/<[^>]*>/g, "").match(new RegExp(`.{1,${Math.floor(NARROW)}}`, "g")).map(text => `<mi>${text}</mi>`).join(BREAK);
const letters = (html, width) => part(html, width, slices(html));
const word = text => letters(`<mi mathvariant="normal">${text}</mi>`, text.length);

// Returns a part in parentheses of a fixed height, as its counterpart may be in another <math> element.
function fenced(inside, isTall) {
  const size = isTall ? 'minsize="2.2em" maxsize="2.2em"' : 'stretchy="false"';
  const open = `<mo form="prefix" ${size}>(</mo>`, close = `<mo form="postfix" ${size}>)</mo>`;
  return { ...part(`<mrow>${open}${inside.html}${close}</mrow>`, inside.width + 2, open + inside.pieces + close), open: open + inside.pieces, close };
}

// Returns the pieces of word(a, b).
const callOf = (name, ...parts) => word(name).html + fenced({ pieces: parts.map(({ pieces }) => pieces).join(SIGNS[","] + BREAK) }).pieces;

// Returns a fraction; in pieces, a wide numerator stands after it, and a wide denominator after a slash.
function fraction(above, below) {
  const html = `<mfrac><mrow>${above.html}</mrow><mrow>${below.html}</mrow></mfrac>`, times = TIMES[above.hasNumber ? "\\cdot" : "\\,"];
  const numerator = above.isSum ? fenced(above).pieces : above.pieces, isNumber = /^<mn>[^<]*<.mn>$/.test(below.html);
  const before = `<mfrac><mn>1</mn><mrow>${below.html}</mrow></mfrac>${times}${isNumber ? "" : BREAK}`;
  const wide = below.width > NARROW ? numerator + BREAK + infix("/") + fenced(below).pieces : before + numerator;
  return { ...part(html, Math.max(above.width, below.width) + 0.5, wide), hasNumber: above.hasNumber };
}

// Returns a part with an index and an exponent, of which either may be absent.
function scripted(base, below, above) {
  if (!below && !above) return base;
  const tag = below ? (above ? "msubsup" : "msub") : "msup", scripts = [below, above].filter(Boolean);
  const rows = scripts.map(({ html }) => `<mrow>${html}</mrow>`).join(""), html = `<${tag}>${base.html}${rows}</${tag}>`;
  const width = base.width + 0.7 * sumOf(scripts.map(script => script.width)) + (above ? 1 : 0);
  const power = base.open && above.width <= NARROW / 2 && `${base.open}<msup>${base.close}${rows}</msup>`;
  return { ...part(html, width, power || (above ? callOf("pow", base, above) : slices(html))), isFunction: base.isFunction, hasNumber: base.hasNumber };
}

// Returns cases with a brace before them; in pieces, if(c, a, if(d, b, e)).
function casesOf(rows) {
  const cell = html => `<mtd>${html}</mtd>`, condition = when => (when ? `<mtext>if&#xa0;</mtext>${when.html}` : "<mtext>else</mtext>");
  const table = rows.map(([value, when]) => `<mtr>${cell(value.html)}${cell(condition(when))}</mtr>`).join("");
  const nested = rows.reduceRight((other, [value, when]) => (when ? { pieces: callOf("if", when, value, other) } : value), null);
  const width = Math.max(...rows.map(([value, when]) => value.width + (when?.width ?? 0))) + 4;
  return part(`<mrow><mo form="prefix" stretchy="true">{</mo><mtable>${table}</mtable></mrow>`, width, nested.pieces, STILL_NARROW);
}

class Reader {
  constructor(latex) {
    this.tokens = latex.match(TOKEN).reverse();
  }

  get next() {
    return this.tokens.at(-1);
  }

  take(token) {
    return this.next === token && this.tokens.pop() !== undefined;
  }

  // Reads terms, arguments or sides up to the end of a group. In pieces, lines may break before terms and sides, and after commas.
  row() {
    const terms = [];
    while (!ENDS.has(this.next)) {
      const sign = this.next in SIGNS ? this.tokens.pop() : "", isNegative = sign === "-" ? terms.length === 0 : this.take("-");
      terms.push({ sign, before: (sign === "-" && isNegative ? "" : SIGNS[sign] ?? "") + (isNegative ? MINUS : ""), ...this.term() });
    }
    const [{ before, hasNumber }] = terms, isSum = terms.length > 1 || before !== "", isBroken = ({ sign }, i) => i > 0 && sign !== ">";
    const wide = terms.map((term, i) => (!isBroken(term, i) ? term.before : term.sign === "," ? term.before + BREAK : BREAK + term.before) + term.pieces);
    const width = sumOf(terms.map(term => 2 * term.sign.length + term.width));
    return { ...part(terms.map(term => term.before + term.html).join(""), width, wide.join("")), isSum, hasNumber: hasNumber && before === "" };
  }

  // Reads a product; in pieces, a factor for which the line has no room begins the next.
  term() {
    const factors = [];
    while (!ENDS.has(this.next) && !(this.next in SIGNS)) factors.push({ times: this.next in TIMES ? TIMES[this.tokens.pop()] : "", ...this.power() });
    let room = NARROW;
    const wide = factors.map(({ times, width, pieces }, i) => {
      const breaks = i > 0 && width > room;
      room = (breaks ? NARROW : room) - width;
      return times + (breaks ? BREAK : "") + pieces;
    });
    const width = sumOf(factors.map(factor => factor.width)) + 0.3 * (factors.length - 1);
    return { ...part(factors.map(({ times, html }) => times + html).join(""), width, wide.join("")), hasNumber: factors[0].hasNumber };
  }

  // Reads a part with its scripts, and the argument of a function.
  power() {
    const base = this.scripts(this.primary());
    if (!base.isFunction) return base;
    const isFenced = /\($/.test(this.next), argument = isFenced ? this.primary() : this.power(), head = `${base.html}<mo>&#x2061;</mo>${isFenced ? "" : THIN}`;
    return this.scripts(part(`<mrow>${head}${argument.html}</mrow>`, base.width + argument.width, head + argument.pieces));
  }

  scripts(base) {
    return scripted(base, this.take("_") && this.group(), this.take("^") && this.group());
  }

  primary() {
    const token = this.tokens.pop(), name = token.slice(1);
    if (/^\d/.test(token)) return { ...part(`<mn>${token}</mn>`, token.length), hasNumber: true };
    if (token === "(" || token === "\\left(") return this.fence(token);
    if (token === "\\left|") return this.bars();
    if (token === "\\frac") return fraction(this.group(), this.group());
    if (token === "\\sqrt") return this.root();
    if (token === "\\begin") return this.cases();
    if (token === "\\dots") return part("<mo>…</mo>", 2);
    if (token === "\\partial") return part("<mo>∂</mo>", 1);
    if (token === "\\mathrm") return word(this.text());
    if (token === "\\operatorname") return { ...word(this.text()), isFunction: true };
    if (token in DOTS) return this.dotted(DOTS[token]);
    if (FUNCTION.test(name)) return { ...word(name), isFunction: true };
    return part(`<mi>${name ? `&${name};` : token}</mi>`, 1);
  }

  group() {
    this.take("{");
    const inside = this.row();
    this.take("}");
    return inside;
  }

  text() {
    let text = "";
    for (this.take("{"); !this.take("}"); ) text += this.tokens.pop().replace("\\_", "_");
    return text;
  }

  dotted(dots) {
    const inside = this.group();
    return letters(`<mover accent="true">${inside.html}<mo>${dots}</mo></mover>`, inside.width);
  }

  fence(open) {
    const inside = this.row();
    this.tokens.pop();
    return fenced(inside, open !== "(");
  }

  bars() {
    const inside = this.row();
    this.tokens.pop();
    return part(`<mrow><mo>|</mo>${inside.html}<mo>|</mo></mrow>`, inside.width + 2, callOf("abs", inside));
  }

  root() {
    const inside = this.group();
    return part(`<msqrt>${inside.html}</msqrt>`, inside.width + 2, callOf("sqrt", inside), STILL_NARROW);
  }

  cases() {
    const rows = [];
    this.text();
    do {
      const value = this.row();
      this.tokens.pop();
      this.tokens.pop();
      rows.push([value, this.text() === "if" ? this.row() : null]);
    } while (this.take("\\\\"));
    this.tokens.pop();
    this.text();
    return casesOf(rows);
  }
}

// Returns MathML between whose elements lines may break.
const mathmlOf = latex => MATH + new Reader(latex).row().pieces + "</math>";
