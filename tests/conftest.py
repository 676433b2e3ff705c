"""What all tests share: options, and no skipping where CI says so."""

import os

import pytest


def pytest_addoption(parser):
    parser.addoption("--regenerate", action="store_true", help="redraw the golden pictures")


@pytest.fixture
def regenerate(request):
    return request.config.getoption("--regenerate")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    """Where EYAS_TEST_NO_SKIP is set (CI), a skipped test has failed: nothing may be missing."""
    report = (yield).get_result()
    if os.environ.get("EYAS_TEST_NO_SKIP") and report.skipped and not hasattr(report, "wasxfail"):
        report.outcome = "failed"
        report.longrepr = f"skipped, which is not allowed here: {report.longrepr}"
