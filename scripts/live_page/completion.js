// Offers words below the caret of a text: while a word is typed, after "<" and "</", or by Ctrl and the space bar.
"use strict";

const LINE = 19; // px, the height of a line in editor.css

// Lets the text area offer the words of the language. Enter or Tab takes one, the arrows choose, Escape closes the list.
function offerWords(source, list, language) {
  let offered = { word: "", words: [] }, chosen = 0;
  const width = widthOfLetters(source);

  function close() {
    offered = { word: "", words: [] };
    list.hidden = true;
    source.removeAttribute("aria-activedescendant");
  }

  function draw() {
    list.replaceChildren(...offered.words.map(({ label, note }, i) => {
      const item = document.createElement("li"), name = document.createElement("b"), text = document.createElement("span");
      [name.textContent, text.textContent] = [label, note];
      item.append(name, text);
      item.id = `word${i}`;
      item.setAttribute("role", "option");
      item.setAttribute("aria-selected", i === chosen);
      item.addEventListener("pointerdown", (event) => {
        event.preventDefault(); // the text keeps the focus
        take(i);
      });
      return item;
    }));
    list.children[chosen]?.scrollIntoView({ block: "nearest" });
    source.setAttribute("aria-activedescendant", `word${chosen}`);
  }

  function place() {
    const lines = source.value.slice(0, source.selectionStart).split("\n"), style = getComputedStyle(source);
    const x = parseFloat(style.paddingLeft) + width * (lines.at(-1).length - offered.word.length) - source.scrollLeft;
    const y = parseFloat(style.paddingTop) + LINE * lines.length - source.scrollTop;
    list.style.left = `${Math.max(0, Math.min(x, source.clientWidth - list.offsetWidth))}px`;
    list.style.top = y + list.offsetHeight > source.clientHeight ? `${Math.max(0, y - LINE - list.offsetHeight)}px` : `${y}px`;
  }

  function offer(isWished) {
    const at = source.selectionStart, found = at === source.selectionEnd ? wordsAt(source.value, at, language) : { word: "", words: [] };
    const isBegun = found.word || /<\/?$/.test(source.value.slice(0, at)) || isWished;
    if (!isBegun || found.words.length === 0) {
      close();
      return;
    }
    [offered, chosen] = [found, 0];
    list.hidden = false;
    draw();
    place();
  }

  function take(i) {
    const { text } = offered.words[i], begin = source.selectionStart - offered.word.length, caret = text.indexOf("|");
    source.setSelectionRange(begin, source.selectionStart);
    document.execCommand("insertText", false, text.replace("|", ""));
    close();
    if (caret >= 0) source.setSelectionRange(begin + caret, begin + caret);
  }

  function pressed(event) {
    const count = offered.words.length;
    if (event.key === " " && event.ctrlKey) offer(true);
    else if (count === 0 || event.ctrlKey || event.metaKey) return;
    else if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      chosen = (chosen + (event.key === "ArrowDown" ? 1 : count - 1)) % count;
      draw();
    } else if (event.key === "Enter" || event.key === "Tab") take(chosen);
    else if (event.key === "Escape") close();
    else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  source.addEventListener("keydown", pressed);
  source.addEventListener("input", (event) => event.inputType?.startsWith("insert") && event.data !== null && event.data.length === 1 ? offer(false) : close());
  for (const event of ["blur", "scroll", "click"]) source.addEventListener(event, close);
  return offer;
}

// Returns the width of a letter of the text in px.
function widthOfLetters(source) {
  const context = document.createElement("canvas").getContext("2d");
  context.font = getComputedStyle(source).font;
  return context.measureText("m").width;
}
