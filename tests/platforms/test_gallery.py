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


def broken_links():
    """
    Yield the links between pages whose file or anchor does not exist. Excluded are 404.html, which is for a server, and fragments of the
    laboratory's address, which name systems.
    """
    pages = {page: page.read_text(encoding="utf-8") for page in SITE.rglob("*.html") if page.name not in ("404.html", "laboratory.html") and "systems" not in page.parts}
    for page, text in pages.items():
        for link in re.findall(r'(?:href|src)="([^"]+)"', text):
            path, _, anchor = unquote(link).partition("#")
            target = (page.parent / path).resolve() if path else page
            if not re.match(r"[a-z]+:|//", link) and not (target.exists() and (not anchor or target not in pages or f'id="{anchor}"' in pages[target])):
                yield page.name, link


def test_the_gallery():
    with alone(ROOT / "build" / "gallery.lock"):
        subprocess.run([ROOT / "scripts" / "package" / "build-laboratory"], check=True)
        subprocess.run([sys.executable, ROOT / "scripts" / "commands" / "gallery.py"], check=True)
    cards = (SITE / "gallery.html").read_text()
    assert (SITE / "laboratory.html").exists() and 'href="laboratory.html"' in cards
    links = re.findall(r'(?:href|src)="(systems/[^"]*)"', cards)
    assert {link.split("/")[1] for link in links} == set(fmu.all_names())
    assert cards.count('<pre class="scene"') == len(fmu.all_names())
    assert [link for link in links if not (SITE / unquote(link)).exists()] == []
    assert list(broken_links()) == []
    fetched, complaints = [], []
    with chromium() as browser:
        page = browser.new_page()
        page.on("request", lambda request: fetched.append(request.url))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        for place in ("index.html", "gallery.html", "fmu/TUTORIAL.html", "fmu/index.html", "fmu/elements/friction.html", "python.html"):
            page.goto((SITE / place).as_uri())
        page.click("text=Search")
        page.fill("#mkdocs-search-query", "stiction")
        page.press("#mkdocs-search-query", "End")
        page.wait_for_selector("#mkdocs-search-results article")
        assert "fmu/reference/switching.html#friction" in page.inner_html("#mkdocs-search-results")
        page.goto((SITE / "gallery.html").as_uri())
        page.click('a[href="systems/NewtonsCradle/live.html"] >> text=live')
        page.wait_for_selector("body[data-ready]")
        page.goto((SITE / "gallery.html").as_uri())
        page.click('a[href="laboratory.html#HeavyTop"]')
        page.wait_for_function("window.bench && bench.runs > 0", timeout=90000)
        assert '<system name="HeavyTop"' in page.input_value("#source")
        page.click("text=Gallery")
        page.wait_for_url("**/gallery.html")
        for scheme in ("dark", "light"):
            page.emulate_media(color_scheme=scheme)
            page.wait_for_function("scheme => document.documentElement.dataset.bsTheme === scheme", arg=scheme)
    assert complaints == []
    assert [url for url in fetched if not url.startswith(("file:", "blob:", "data:"))] == []
