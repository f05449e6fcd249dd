// Lists completions below the caret of a text: while a word is typed, after "<" and "</", or by Ctrl and the space bar.
"use strict";

const LINE_HEIGHT = 19; // px, the height of a line in editor.css
const LONGEST_LIST = 240; // px

// Completes words of the language in a text area. Enter or Tab accepts one, the arrows choose, Escape closes the list. Returns the function that opens the list.
function addCompletion(source, list, language) {
  let shown = { word: "", completions: [] }, chosen = 0;
  const width = widthOfLetter(source);

  function close() {
    shown = { word: "", completions: [] };
    list.hidden = true;
    source.removeAttribute("aria-activedescendant");
  }

  function draw() {
    list.replaceChildren(...shown.completions.map(({ label, note }, i) => {
      const item = document.createElement("li"), name = document.createElement("b"), text = document.createElement("span");
      [name.textContent, text.textContent] = [label, note];
      item.append(name, text);
      item.id = `word${i}`;
      item.setAttribute("role", "option");
      item.setAttribute("aria-selected", i === chosen);
      item.addEventListener("mousedown", (event) => event.preventDefault()); // the text keeps the focus
      item.addEventListener("click", () => accept(i));
      return item;
    }));
    moveToCaret();
    list.children[chosen]?.scrollIntoView({ block: "nearest" });
    source.setAttribute("aria-activedescendant", `word${chosen}`);
  }

  // Places the list below the caret's line, or above it where there is more space.
  function moveToCaret() {
    const lines = source.value.slice(0, source.selectionStart).split("\n"), style = getComputedStyle(source);
    const x = parseFloat(style.paddingLeft) + width * (lines.at(-1).length - shown.word.length) - source.scrollLeft;
    const y = parseFloat(style.paddingTop) + LINE_HEIGHT * lines.length - source.scrollTop;
    const below = source.clientHeight - y, above = y - LINE_HEIGHT, isBelow = below >= Math.min(above, LONGEST_LIST);
    list.style.maxHeight = `${Math.min(LONGEST_LIST, isBelow ? below : above)}px`;
    list.style.left = `${Math.max(0, Math.min(x, source.clientWidth - list.offsetWidth))}px`;
    list.style.top = `${isBelow ? y : above - list.offsetHeight}px`;
  }

  function complete(isRequested) {
    const at = source.selectionStart, found = at === source.selectionEnd ? completionsAt(source.value, at, language) : { word: "", completions: [] };
    const isBegun = found.word || /<\/?$/.test(source.value.slice(0, at)) || isRequested;
    if (!isBegun || found.completions.length === 0) {
      close();
      return;
    }
    [shown, chosen] = [found, 0];
    list.hidden = false;
    draw();
  }

  function accept(i) {
    const { text } = shown.completions[i], begin = source.selectionStart - shown.word.length, caret = text.indexOf("|");
    source.setSelectionRange(begin, source.selectionStart);
    document.execCommand("insertText", false, text.replace("|", ""));
    close();
    if (caret >= 0) source.setSelectionRange(begin + caret, begin + caret);
  }

  function onKey(event) {
    const count = shown.completions.length;
    if (event.key === " " && event.ctrlKey) complete(true);
    else if (count === 0 || event.ctrlKey || event.metaKey) return;
    else if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      chosen = (chosen + (event.key === "ArrowDown" ? 1 : count - 1)) % count;
      draw();
    } else if (event.key === "Enter" || event.key === "Tab") accept(chosen);
    else if (event.key === "Escape") close();
    else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  source.addEventListener("keydown", onKey);
  source.addEventListener("input", (event) => event.inputType?.startsWith("insert") && event.data !== null && event.data.length === 1 ? complete(false) : close());
  for (const event of ["blur", "click"]) source.addEventListener(event, close);
  source.addEventListener("scroll", () => list.hidden || moveToCaret());
  return complete;
}

// Returns the width of a letter of the text in px.
function widthOfLetter(source) {
  const context = document.createElement("canvas").getContext("2d");
  context.font = getComputedStyle(source).font;
  return context.measureText("m").width;
}
