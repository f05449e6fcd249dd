"""Tasks in live pages: measured from samples, and ended when anything but an input is changed."""

import re

import numpy as np
import pytest

from driven_chromium import PHONE, browser, opened, page_of_fmu  # noqa: F401

pytestmark = pytest.mark.long

# A driver of the crane: speeds in proportion to the distances that are left, set by the sliders.
DRIVE = """() => {
  const sliderOf = (name) => document.querySelector(`input[type=range][aria-label=${name}]`), valueOf = (name) => live.history.samples.at(-1)[0][live.names.indexOf(name)];
  const choose = (name, value) => {
    const [low, high] = live.rangeOf(name);
    sliderOf(name).value = String((1000 * (Math.max(-0.8, Math.min(0.8, value)) - low)) / (high - low));
    sliderOf(name).dispatchEvent(new Event("input"));
  };
  window.driver = setInterval(() => {
    choose("trolleySpeed", 0.3 * (15 - valueOf("x")));
    choose("hoistSpeed", 0.5 * (10 - valueOf("l")));
  }, 20);
}"""


def test_levers_on_a_phone(browser, page_of_fmu):
    """An input has 0 in the middle of its slider. The scene stays in sight above the levers; there are no hints for keys."""
    with opened(browser, page_of_fmu("GantryCrane"), **PHONE) as page:
        page.tap("text=At rest, levers in the middle")
        for name, largest in (("trolleySpeed", 2), ("hoistSpeed", 1)):
            lever = page.get_by_role("slider", name=name)
            assert lever.input_value() == "500" and page.evaluate("name => live.rangeOf(name)", name) == [-largest, largest]
            lever.fill("250")
            assert page.get_by_role("spinbutton", name=name).input_value() == f"{-largest / 2:g}"
        page.evaluate("document.querySelector('input[type=range][aria-label=m]').scrollIntoView()")
        view = page.locator("#view").bounding_box()
        assert page.evaluate("scrollY") > 400 and view["y"] == 0 and view["height"] <= 400
        assert page.locator(".keys").count() == 2 and not page.locator(".keys").first.is_visible()


def test_a_load_is_delivered(browser, page_of_fmu):
    """The task starts from its preset, and is done at the end of the first 2 s in which the load hangs at rest at its place."""
    with opened(browser, page_of_fmu("GantryCrane")) as page:
        page.get_by_role("spinbutton", name="m", exact=True).fill("300")
        page.get_by_role("spinbutton", name="m", exact=True).press("Enter")
        page.fill("#speed", "1")
        page.click("text=Bring the load to rest")
        page.evaluate(DRIVE)
        page.wait_for_function("document.querySelector('.tasks div').textContent.startsWith('done')", timeout=60000)
        page.evaluate("clearInterval(driver)")
        text, names = page.inner_text(".tasks div"), page.evaluate("live.names")
        times, samples = page.evaluate("[live.history.times, live.history.samples.map(([run]) => [...run])]")
        assert page.get_by_role("spinbutton", name="m", exact=True).input_value() == "1500"
        done = float(re.fullmatch(r"done in ([0-9.]+) s; best ([0-9.]+) s", text)[1])
        page.click("text=Bring the load to rest")
        page.get_by_role("spinbutton", name="m", exact=True).fill("300")
        page.get_by_role("spinbutton", name="m", exact=True).press("Enter")
        assert page.inner_text(".tasks div") == f"ended, since a value other than an input was changed; best {done:.2f} s"
    x, length, theta, v, w, omega = (np.array(samples)[:, names.index(name)] for name in ("x", "l", "theta", "v", "w", "omega"))
    speed = v + w * np.sin(theta) + length * omega * np.cos(theta)
    met = (np.abs(x + length * np.sin(theta) - 15) <= 0.3) & (np.abs(length * np.cos(theta) - 10) <= 0.3) & (np.abs(speed) <= 0.15)
    times = np.array(times)
    assert met[(times > done - 2 - 1e-6) & (times < done + 1e-6)].all()
    first = times[np.flatnonzero(~met & (times < done))[-1] + 1]
    assert done - first == pytest.approx(2, abs=0.2)
