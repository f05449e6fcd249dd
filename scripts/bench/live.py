"""Measure the times of communication steps in live pages, and print them beside those of the native FMUs; for scripts/bench/live."""

import sys
import tempfile
import time
from pathlib import Path

import fmu
from driven_chromium import chromium, opened
from scripts.library.live_page.page import page_of

SYSTEMS = ("DoublePendulum", "FourBar")
UNTIL, RUNS = 30.0, 12  # simulated time in s; runs of each, in turn, of which the fastest counts


def native_seconds(name):
    step, instance = float(fmu.description(name).defaultExperiment.stepSize), fmu.Instance(name, logging=False)
    instance.initialize()
    begin = time.perf_counter()
    for i in range(round(UNTIL / step)):
        instance.fmu.doStep(i * step, step)
    seconds = time.perf_counter() - begin
    instance.free()
    return seconds


def page_seconds(page):
    page.click("#reset")
    return page.evaluate("until => live.run(until)", UNTIL)["seconds"]


def compare(browser, name, folder):
    file = Path(folder) / f"{name}.html"
    file.write_text(page_of(fmu.archive(name)), encoding="utf-8")
    with opened(browser, file) as page:
        times = [(page_seconds(page), native_seconds(name)) for _ in range(RUNS)]
    in_page, native = map(min, zip(*times))
    steps = UNTIL / float(fmu.description(name).defaultExperiment.stepSize)
    print(f"| {name} | {1e6 * in_page / steps:.2f} | {1e6 * native / steps:.2f} | {in_page / native:.2f} |", flush=True)


print("| system | in the page, µs a step | native, µs a step | ratio |\n| --- | ---: | ---: | ---: |")
with chromium() as browser, tempfile.TemporaryDirectory() as folder:
    for name in sys.argv[1:] or SYSTEMS:
        compare(browser, name, folder)
