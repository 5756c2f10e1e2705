"""report.pdf from report.html, by a program that is not among the packages of Talus: Chromium or WeasyPrint."""

import os
import shutil
import subprocess
import tempfile

CHROMIUM = ("chromium", "chromium-browser", "google-chrome")
MISSING = "--pdf needs Chromium or WeasyPrint, and neither is installed: apt-get install chromium, or apt-get install weasyprint"


def browser():
    """The path of a Chromium; None without one."""
    return next(filter(None, map(shutil.which, CHROMIUM)), None)


def headless(*options):
    """The command that starts it without a display, with a profile of its own that is removed by the caller."""
    return [browser(), "--headless", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", *(["--no-sandbox"] if os.geteuid() == 0 else []), *options]


def print_report(page):
    """Writes the pdf beside the page and returns its path. Raises ValueError where no program can, or where it failed."""
    path = page.with_suffix(".pdf")
    path.unlink(missing_ok=True)
    if browser():
        with tempfile.TemporaryDirectory() as profile:
            done = subprocess.run(headless(f"--user-data-dir={profile}", "--no-pdf-header-footer", "--virtual-time-budget=5000", f"--print-to-pdf={path.resolve()}",
                                           page.resolve().as_uri()), capture_output=True, text=True, timeout=300, check=False)
    elif shutil.which("weasyprint"):
        done = subprocess.run(["weasyprint", page, path], capture_output=True, text=True, timeout=600, check=False)
    else:
        raise ValueError(MISSING)
    if not path.exists():
        raise ValueError(f"{page} could not be printed: {done.stderr.strip().splitlines()[-1:]}")
    return path
