"""The report of a measurement in a browser: on a phone, in the dark, for everybody, on paper."""

from __future__ import annotations

import io

import pytest

from dampbalance import identify
from folders import ROOT
from paper import axe

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    records = sorted((ROOT / "config/records/example").glob("level*.csv"))[::2]
    found = identify(records, 2310.0, approaches=["direct"])
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(found.report(), encoding="utf-8")
    return path


@pytest.mark.skipif(axe.SKIP, reason=axe.REASON)
def test_axe_finds_nothing_to_mend_in_a_report(browser, file):
    assert axe.found(browser, file) == []


def test_a_report_fits_a_phone_and_shows_its_pictures(browser, file):
    view = axe.opened(browser, file, "phone", "dark")
    assert view.evaluate("document.documentElement.scrollWidth") <= axe.SIZES["phone"]["width"]
    drawn = view.evaluate(
        "Promise.all([...document.images].map(async (one) => { await one.decode(); return one.naturalWidth; }))"
    )
    assert len(drawn) == 4
    assert min(drawn) > 0
    view.context.close()


def test_a_report_prints_on_few_pages_with_the_verdict_on_the_first(browser, file):
    from pypdf import PdfReader

    view = axe.opened(browser, file, "desktop", "dark")
    pages = PdfReader(io.BytesIO(view.pdf(format="A4"))).pages
    assert len(pages) <= 6
    assert "can be used as they stand" in " ".join(pages[0].extract_text().split())
    view.context.close()
