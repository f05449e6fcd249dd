"""Fixtures for the built FMUs, of which every test uses the packed archives, and reports of sizes and times."""

import os
from collections import Counter, defaultdict

import pytest

# Matrices are small, so that threads of linear algebra would wait for each other a hundred times longer than they compute. NumPy reads this
# at its import.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import fmi3  # noqa: E402
import fmu  # noqa: E402
import sizes as size_table  # noqa: E402
from linked import sizes  # noqa: E402


def pytest_addoption(parser):
    parser.addoption("--renew-sizes", action="store_true", help="write measured sizes into tests/sizes.csv, which holds those of the last release; without -n")


def pytest_generate_tests(metafunc):
    """Run a test with an argument `name` for every system, unless it lists systems itself."""
    named = any(
        "name" in mark.args[0].replace(" ", "").split(",") for mark in metafunc.definition.iter_markers("parametrize")
    )
    if "name" in metafunc.fixturenames and not named:
        metafunc.parametrize("name", fmu.all_names())


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Of a test of many systems, only those of each kind are daily; the others are long."""
    further = set(fmu.all_names() + fmu.further_names()).difference(fmu.OF_EACH_KIND)
    named = [(item, item.callspec.params["name"]) for item in items if hasattr(item, "callspec") and "name" in item.callspec.params]
    tested = defaultdict(set)  # systems by function
    for item, name in named:
        tested[item.function].add(name)
    for item, name in named:
        if name in further and len(tested[item.function]) > 2 * len(fmu.OF_EACH_KIND):
            item.add_marker(pytest.mark.long)


def processor_seconds():
    """Processor time of this process and of its finished children, independent of the machine's load."""
    return sum(os.times()[:4])


known = 0.0  # processor time at the last report, in s


def pytest_collection_finish():
    global known
    known = processor_seconds()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport():
    global known
    report, now = (yield), processor_seconds()
    report.processor_seconds, known = now - known, now
    return report


def seconds_of_files(terminalreporter):
    """Processor time by file of tests, including builds, in descending order."""
    seconds = Counter()
    for reports in terminalreporter.stats.values():
        for report in reports:
            if isinstance(report, pytest.TestReport):
                seconds[report.nodeid.partition("::")[0]] += getattr(report, "processor_seconds", 0.0)
    return seconds.most_common()


def pytest_terminal_summary(terminalreporter):
    terminalreporter.write_line(f"\n{'FMU':34}{'archive':>10}{'library':>10}{'SUNDIALS':>10}{'equations':>10}  bytes")
    for name, *numbers in sizes():
        terminalreporter.write_line(f"{name:34}" + "".join(f"{number:10}" for number in numbers))
    taken = seconds_of_files(terminalreporter)
    terminalreporter.write_line(f"\n{sum(seconds for _, seconds in taken):.0f} s of the processor for all tests, of that by file:")
    for name, seconds in taken[:30]:
        terminalreporter.write_line(f"{seconds:7.0f}  {name}")


def created(kind):
    """Yield a function that creates instances; free these afterwards."""
    instances = []

    def create(name, **options):
        instances.append(kind(name, **options))
        return instances[-1]

    yield create
    for instance in instances:
        instance.free()


@pytest.fixture
def open_fmu():
    """Yield a function that creates instances of FMI 2.0, which are freed after the test."""
    yield from created(fmu.Instance)


@pytest.fixture
def check_size(request):
    """A function that compares a size with that of the last release, or writes it into the table with --renew-sizes."""
    return size_table.renew if request.config.getoption("--renew-sizes") else size_table.check


@pytest.fixture
def opened():
    """The same for FMI 3.0."""
    yield from created(fmi3.Instance)
