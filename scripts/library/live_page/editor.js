// Edits a system beside the page in which it runs. Each pause in typing derives it; the button Run runs it.
"use strict";

const PAUSE = 300; // ms from the last key press until the system is derived
const TIMEOUT = 15; // s after which a derivation is aborted
document.currentScript.remove();
const template = `<!doctype html>\n${document.documentElement.outerHTML}`; // the page as it was written, a template for saved pages
const $ = (id) => document.getElementById(id);
const data = JSON.parse($("data").textContent);
const bench = (window.bench = { run, runs: 0 }); // for tests and the browser's console
let files = { ...data.files }, file = data.file, opened = data.file, robot = data.robot; // robot: options for the file of a robot
let checker = null, number = 0, derived = null; // the worker, the number of the last request to it, and the last successful result
let isRunRequested = true, startsPlaying = false, timer = null, timeout = null;

// Returns the normalized form of a path in lagc's messages, as it is in `files`.
function nameOf(path) {
  const parts = [];
  for (const part of path.split("/")) {
    if (part === "..") parts.pop();
    else if (part) parts.push(part);
  }
  return parts.join("/");
}

// Parses a message of lagc: file, line (0 without), isWarning and text.
function messageOf(line) {
  const found = /^(.*?):(?:(\d+):)? (warning: )?(.*)$/.exec(line), name = nameOf(found?.[1] ?? "");
  return name in files ? { name, line: Number(found[2] ?? 0), isWarning: Boolean(found[3]), text: found[4] } : { name: file, line: 0, isWarning: false, text: line };
}

// Returns the range of a message's mistake in a text. It is the first quoted word of the message that is in its line, or else the line.
function rangeOfMistake(source, { line, text }) {
  const lines = source.split("\n"), begin = lines.slice(0, line - 1).reduce((sum, { length }) => sum + length + 1, 0), content = lines[line - 1] ?? "";
  for (const [, word] of text.matchAll(/'([^']+)'/g)) {
    const escaped = word.replace(/[^\w\s]/g, "\\$&"), found = new RegExp(`(?<!\\w)${escaped}(?!\\w)|${escaped}`).exec(content);
    if (found) return [begin + found.index, begin + found.index + word.length];
  }
  return [begin + content.length - content.trimStart().length, begin + content.length];
}

// Selects a message's mistake, and scrolls to it.
function goTo(message) {
  if (opened !== message.name) openFile(message.name);
  const source = $("source"), [begin, end] = rangeOfMistake(source.value, message), column = begin - source.value.lastIndexOf("\n", begin - 1) - 1;
  source.focus();
  source.setSelectionRange(begin, end);
  source.scrollTop = Math.max(0, (message.line - 5) * LINE_HEIGHT);
  source.scrollLeft = Math.max(0, (column + Math.min(end - begin, 20) + 5) * widthOfLetter(source) - source.clientWidth);
}

function showMessages(messages) {
  const items = messages.map((message) => {
    const button = document.createElement("button"), item = document.createElement("li");
    const position = `${message.name === file ? "" : `${message.name}, `}${message.line > 0 ? `line ${message.line}: ` : ""}`;
    button.textContent = `${position}${message.isWarning ? "warning: " : ""}${message.text}`;
    button.classList.toggle("warning", message.isWarning);
    button.addEventListener("click", () => goTo(message));
    item.append(button);
    return item;
  });
  $("messages").replaceChildren(...items);
  showLines(messages.filter(({ name, isWarning, line }) => name === opened && !isWarning && line > 0));
}

function showLines(mistakes = []) {
  const count = $("source").value.split("\n").length, wrong = new Set(mistakes.map(({ line }) => line));
  const marks = Array.from({ length: count }, (_, i) => (wrong.has(i + 1) ? `<span class="wrong">${i + 1}</span>` : i + 1));
  $("lines").innerHTML = `${marks.join("\n")}\n`;
  $("colors").innerHTML = `${highlighted($("source").value, mistakes.map((mistake) => rangeOfMistake($("source").value, mistake)))}\n`;
  scrollTogether();
}

// Scrolls the line numbers and the colors with the text.
function scrollTogether() {
  $("lines").scrollTop = $("colors").scrollTop = $("source").scrollTop;
  $("colors").scrollLeft = $("source").scrollLeft;
}

// Begins a new element in a line of its own, below the caret's line or before the end of the system.
function insertElement(complete) {
  const source = $("source"), { value } = source, last = value.lastIndexOf("</"), line = value.indexOf("\n", source.selectionStart);
  const at = line < 0 || line >= last ? Math.max(0, value.lastIndexOf("\n", last)) : line;
  source.focus();
  source.setSelectionRange(at, at);
  document.execCommand("insertText", false, "\n  <");
  source.scrollTop = (source.value.slice(0, at).split("\n").length - 1) * LINE_HEIGHT; // leaves space below for the list
  source.scrollLeft = 0;
  complete(true);
}

function showState(text, kind = "") {
  $("state").textContent = text;
  $("state").className = kind;
}

function receive({ data: { number: answered, messages: text, result, milliseconds } }) {
  clearTimeout(timeout);
  if (answered !== number) return;
  const messages = text.split("\n").filter((line) => line).map(messageOf), errors = messages.filter(({ isWarning }) => !isWarning).length;
  showMessages(messages);
  derived = result ?? null;
  showState(result ? `derived in ${Math.round(milliseconds)} ms` : `${errors} ${errors === 1 ? "error" : "errors"}`, result ? "valid" : "wrong");
  if (result && isRunRequested) show();
}

async function startChecker() {
  const source = new TextDecoder().decode(await unpacked(data.checker));
  checker?.terminate();
  checker = new Worker(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
  checker.onmessage = receive;
  checker.postMessage({ bytes: window.laboratoryBytes });
}

function check() {
  number++;
  clearTimeout(timer);
  clearTimeout(timeout);
  showState("deriving …");
  checker.postMessage({ files, file, robot, number });
  timeout = setTimeout(() => {
    showState(`not derived within ${TIMEOUT} s`, "wrong");
    startChecker();
  }, 1000 * TIMEOUT);
}

// Shows the page of the system that was derived last.
function show() {
  isRunRequested = false;
  const { modelDescription, equations, pulled } = derived;
  const inner = { ...data.common, startsPlaying, modelDescription: { text: modelDescription }, equations: { text: equations }, pulled: pulled && { text: pulled }, system: files[file], laboratory: { files, file, robot } };
  $("page").srcdoc = pageText.replace("@DATA@", () => JSON.stringify(inner).replaceAll("<", "\\u003c"));
  bench.runs++;
  startsPlaying = true; // after a change the system runs at once
}

function run() {
  isRunRequested = true;
  check();
}

function openFile(name) {
  opened = name;
  $("files").value = name;
  $("source").value = files[name];
  showLines();
}

function listFiles() {
  $("files").replaceChildren(...Object.keys(files).map((name) => new Option(name, name)));
  $("files").hidden = Object.keys(files).length < 2;
  openFile(file);
}

function save(name, content, type) {
  const link = Object.assign(document.createElement("a"), { download: name, href: URL.createObjectURL(new Blob([content], { type })) });
  link.click();
  URL.revokeObjectURL(link.href);
}

// Returns the name for a saved file: that of the system or robot in it, or else that of the file.
const savedName = (path) => /<(?:system|robot)\b[^>]*?\sname\s*=\s*["']([^"'<]+)/.exec(files[path])?.[1] ?? path.split("/").pop().replace(/\.[^.]*$/, "");

// Returns this page with the present files.
function pageNow() {
  const now = JSON.stringify({ ...data, files, file, robot }).replaceAll("<", "\\u003c");
  return template.replace(/(<script id="data" type="application\/json">)[^]*?(<\/script>)/, (all, begin, end) => begin + now + end);
}

function onInput() {
  files = { ...files, [opened]: $("source").value };
  showLines();
  checkSoon();
}

// Checks after a pause in typing; not while a word is chosen from the list, or an empty value is filled.
function checkSoon() {
  const isComplete = ({ value, selectionStart: at }) => $("completions").hidden && value.slice(at - 1, at + 1) !== '""';
  clearTimeout(timer);
  timer = setTimeout(() => (isComplete($("source")) ? check() : checkSoon()), PAUSE);
}

// Types two spaces for Tab, and repeats the indentation after Enter. Tab after Escape leaves the text.
function indent(event) {
  const source = $("source"), before = source.value.slice(0, source.selectionStart), mayLeave = isAfterEscape;
  isAfterEscape = event.key === "Escape";
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) run();
  else if (event.key === "Tab" && !event.shiftKey && !mayLeave) document.execCommand("insertText", false, "  ");
  else if (event.key === "Enter") document.execCommand("insertText", false, `\n${/[ \t]*(?=[^\n]*$)/.exec(before.slice(before.lastIndexOf("\n") + 1))[0]}`);
  else return;
  event.preventDefault();
}

function listExamples() {
  const names = Object.keys(data.examples ?? {});
  $("examples").hidden = names.length === 0;
  $("examples").replaceChildren(new Option("Systems", ""), ...names.map((name) => new Option(name, name)));
  $("examples").addEventListener("change", () => openExample($("examples").value) && run());
  $("home").hidden = !data.home;
  $("home").href = data.home ?? "";
}

// Opens an example; returns false if there is none of that name.
function openExample(name) {
  const chosen = data.examples?.[name];
  if (!chosen) return false;
  ({ file } = chosen);
  files = { ...chosen.files };
  robot = [];
  listFiles();
  return true;
}

function addActions() {
  $("run").addEventListener("click", run);
  $("source").addEventListener("input", onInput);
  const complete = addCompletion($("source"), $("completions"), language);
  $("insert").addEventListener("click", () => insertElement(complete));
  $("source").addEventListener("keydown", indent);
  $("source").addEventListener("scroll", scrollTogether);
  $("files").addEventListener("change", () => openFile($("files").value));
  $("saveFile").addEventListener("click", () => save(`${savedName(opened)}.${opened.split(".").pop()}`, files[opened], "text/xml"));
  $("savePage").addEventListener("click", () => save(`${savedName(file)}-edit.html`, pageNow(), "text/html"));
  $("divider").addEventListener("pointerdown", (event) => $("divider").setPointerCapture(event.pointerId));
  $("divider").addEventListener("pointermove", (event) => {
    if (!$("divider").hasPointerCapture(event.pointerId)) return;
    document.body.style.setProperty("--share", `${Math.max(200, Math.min(innerWidth - 300, event.clientX))}px`);
  });
}

let pageText, language;
let isAfterEscape = false; // true if the last key was Escape

async function begin() {
  pageText = new TextDecoder().decode(await unpacked(data.page));
  window.laboratoryBytes = await unpacked(data.laboratory);
  language = JSON.parse(new TextDecoder().decode(await unpacked(data.language)));
  listExamples();
  if (!openExample(decodeURIComponent(location.hash.slice(1)))) listFiles();
  addActions();
  await startChecker();
  run();
}

bench.started = begin();
