"""Draw the animated picture of the README as live pages draw their systems in Chromium: moving_picture.py FOLDER_OF_FMUS PICTURE.gif [SECONDS]"""

import io
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from scripts.library.live_page.page import page_of

FRAMES_PER_SECOND = 16
WIDTH, HEIGHT = 240, 240  # size of a scene in pixels
COLORS = 48
SYSTEMS = {"NewtonsCradle": {}, "DoublePendulum": {"theta1": 2.0, "theta2": 2.5}, "PassiveWalker": {}}

# Only the scene is shown, in one size.
STYLE = f"""body > *, main > *, .tools {{ display: none !important }} main, #view {{ display: block !important }}
  #scene {{ width: {WIDTH}px; height: {HEIGHT}px }}"""

# JavaScript: simulates until a time, and waits until the scene is drawn.
RUN = """async until => {
  await live.run(until);
  for (let i = 0; i < 2; i++) await new Promise(requestAnimationFrame);
}"""


def frames_of(browser, file, times):
    """Return the pictures of a live page's scene at these times."""
    page = browser.new_page(viewport={"width": 1200, "height": 700}, color_scheme="light")
    page.goto(file.as_uri())
    page.wait_for_selector("body[data-ready]")
    page.add_style_tag(content=STYLE)
    page.evaluate("dispatchEvent(new Event('resize'))")
    canvas = page.locator("#scene canvas")
    pictures = []
    for time in times:
        page.evaluate(RUN, time)
        pictures.append(Image.open(io.BytesIO(canvas.screenshot())).convert("RGB"))
    page.close()
    return pictures


def beside(pictures):
    """Return the pictures in one row."""
    row = Image.new("RGB", (WIDTH * len(pictures), HEIGHT), "white")
    for i, picture in enumerate(pictures):
        row.paste(picture, (i * WIDTH, 0))
    return row


def main():
    folder, path = Path(sys.argv[1]), Path(sys.argv[2])
    seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 5.0
    times = [i / FRAMES_PER_SECOND for i in range(int(seconds * FRAMES_PER_SECOND))]
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as scratch:
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
        scenes = []
        for name, settings in SYSTEMS.items():
            file = Path(scratch) / f"{name}.html"
            file.write_text(page_of(folder / f"{name}.fmu", None, settings), encoding="utf-8")
            scenes.append(frames_of(browser, file, times))
        browser.close()
    rows = [beside(pictures) for pictures in zip(*scenes, strict=True)]
    palette = rows[-1].quantize(COLORS)  # one for all frames, so that colors do not flicker
    frames = [row.quantize(palette=palette, dither=Image.Dither.NONE) for row in rows]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=1000 // FRAMES_PER_SECOND, loop=0)


if __name__ == "__main__":
    main()
