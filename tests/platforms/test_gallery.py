"""
The site of scripts/gallery, as files in headless Chromium: nothing is missing, nothing is loaded from elsewhere, and the search works.
"""

import re
import subprocess
import sys
from urllib.parse import unquote

import pytest

import fmu
from building import alone
from driven_chromium import chromium
from fmu import ROOT

pytestmark = pytest.mark.release

SITE = ROOT / "build" / "gallery"


def test_the_gallery():
    with alone(ROOT / "build" / "gallery.lock"):
        subprocess.run([ROOT / "scripts" / "build-laboratory"], check=True)
        subprocess.run([sys.executable, ROOT / "scripts" / "gallery.py"], check=True)
    cards = (SITE / "gallery.html").read_text()
    assert (SITE / "laboratory.html").exists() and 'href="laboratory.html"' in cards
    links = re.findall(r'(?:href|src)="(systems/[^"]*)"', cards)
    assert {link.split("/")[1] for link in links} == set(fmu.all_names())
    assert [link for link in links if not (SITE / unquote(link)).exists()] == []
    fetched, complaints = [], []
    with chromium() as browser:
        page = browser.new_page()
        page.on("request", lambda request: fetched.append(request.url))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        for place in ("index.html", "gallery.html", "fmu/TUTORIAL.html", "fmu/index.html"):
            page.goto((SITE / place).as_uri())
        page.click("text=Search")
        page.fill("#mkdocs-search-query", "stiction")
        page.press("#mkdocs-search-query", "End")
        page.wait_for_selector("#mkdocs-search-results article")
        assert "fmu/index.html#friction" in page.inner_html("#mkdocs-search-results")
        page.goto((SITE / "gallery.html").as_uri())
        page.click('a[href="systems/NewtonsCradle/live.html"] >> text=live')
        page.wait_for_selector("body[data-ready]")
    assert complaints == []
    assert [url for url in fetched if not url.startswith(("file:", "blob:", "data:"))] == []
