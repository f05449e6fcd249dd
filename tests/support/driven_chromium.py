"""Live pages in headless Chromium, controlled by a test."""

import contextlib
import functools

import pytest
from playwright.sync_api import sync_playwright

import fmu
from scripts.library.live_page.page import page_of

PHONE = {"viewport": {"width": 420, "height": 800}, "has_touch": True, "is_mobile": True}  # options of opened()
ARGUMENTS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]

# JavaScript: the number of different colours in the picture.
COLORS_SEEN = """() => {
  const canvas = document.querySelector("#scene canvas"), copy = document.createElement("canvas");
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const pen = copy.getContext("2d");
  pen.drawImage(canvas, 0, 0);
  return new Set(new Uint32Array(pen.getImageData(0, 0, copy.width, copy.height).data.buffer)).size;
}"""


@contextlib.contextmanager
def chromium():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def browser():
    with chromium() as browser:
        yield browser


@contextlib.contextmanager
def opened(browser, file, settings="", **options):
    """Yield the page once it is ready, with options of Chromium's context; check at the end that it logged no error."""
    page, complaints = browser.new_page(**{"viewport": {"width": 1200, "height": 700}} | options), []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda message: complaints.append(message.text) if message.type in ("error", "warning") and "GL Driver" not in message.text else None)
    page.goto(file.as_uri() + settings)
    page.wait_for_selector("body[data-ready]", timeout=60000)
    yield page
    page.close()
    assert complaints == []


@pytest.fixture(scope="module")
def page_of_fmu(tmp_path_factory):
    """Return a function that writes the live page of a system once, and returns its file."""
    folder = tmp_path_factory.mktemp("live")

    @functools.cache
    def write(name):
        file = folder / f"{name}.html"
        file.write_text(page_of(fmu.archive(name), cache=fmu.ROOT / "build" / "wasm"), encoding="utf-8")
        return file

    return write
