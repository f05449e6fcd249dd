"""Pages laid out by headless Chromium: content that overflows, scrolls on its own, or is missing."""

import html
import json
import re
import shutil
import subprocess

# JavaScript: the layout errors of a document, as sentences. Half a pixel allows for rounding.
COMPLAINTS = """
function complaints(view) {
  const page = view.document, found = [], width = page.documentElement.clientWidth;
  const name = element => element.localName + " '" + element.textContent.slice(0, 40) + "'";
  if (page.documentElement.scrollWidth > width) found.push("the page is " + page.documentElement.scrollWidth + " wide, not " + width);
  for (const element of page.body.querySelectorAll("*")) {
    const style = view.getComputedStyle(element), box = element.getBoundingClientRect();
    if (box.width === 0) continue;
    if ([style.overflowX, style.overflowY].some(flow => flow === "auto" || flow === "scroll")) found.push(name(element) + " scrolls by itself");
    if (box.left < -0.5 || box.right > width + 0.5) found.push(name(element) + " is out of sight");
    const frame = (element.closest("math") || page.body).getBoundingClientRect();
    if (["mi", "mo", "mn"].includes(element.localName) && (box.top < frame.top - 0.5 || box.bottom > frame.bottom + 0.5)) found.push(name(element) + " is cut");
    if (element.localName === "img" && element.naturalWidth === 0) found.push(element.getAttribute("src") + " is no picture");
  }
  return found;
}
"""


def run(page, folder):
    """Run a page's scripts and return the parsed JSON of the element with the id "result"."""
    file = folder / "page-under-test.html"
    file.write_text(page, encoding="utf-8")
    words = [shutil.which("chromium") or "chromium", "--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files",
             f"--user-data-dir={folder / 'profile'}", "--virtual-time-budget=20000", "--dump-dom", file.as_uri()]  # fmt: skip
    result = subprocess.run(words, capture_output=True, text=True, timeout=120)
    found = re.search(r'<pre id="result">(.*?)</pre>', result.stdout, re.S)
    assert found is not None, result.stderr[-2000:]
    return json.loads(html.unescape(found[1]))


def look_at(files, folder, widths=(1200, 360), script="view => complaints(view)"):
    """
    Apply the script, a function of a window, to each file at each width in pixels. Return the results by (width, index of the file).
    """
    frames = [f'<iframe style="width:{width}px;height:900px" src="{file.as_uri()}"></iframe>' for width in widths for file in files]
    answers = run(f"""<!DOCTYPE html><body>{"".join(frames)}<pre id="result"></pre><script>{COMPLAINTS}
addEventListener("load", () => {{
  const answers = [...document.querySelectorAll("iframe")].map(frame => ({script})(frame.contentWindow));
  document.getElementById("result").textContent = JSON.stringify(answers);
}});</script></body>""", folder)
    return {(width, i): answers[k * len(files) + i] for k, width in enumerate(widths) for i in range(len(files))}
