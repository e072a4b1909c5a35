"""A test in real time that fails while the machine was late is INVALID; on a machine in time it fails."""

import pytest

from emulators.testing.host_watch import HostWatch, lateness

pytest_plugins = ["pytester"]

WORDS = ("-p", "emulators.testing.plugin", "-p", "no:cacheprovider", "-rsf")
SLEEPS = "import threading; threading.Event().wait()"
SUSPENDED = f"""
    import os, signal, subprocess, sys

    def suspended():
        again = f"import os, time; time.sleep(0.6); os.kill({{os.getpid()}}, {{int(signal.SIGCONT)}})"
        child = subprocess.Popen([sys.executable, "-c", again])
        os.kill(os.getpid(), signal.SIGSTOP)
        child.wait()

    def test_fails_after_a_suspension(under_test):
        under_test([sys.executable, "-c", {SLEEPS!r}])
        suspended()
        assert 1 == 2

    def test_passes_in_spite_of_one(under_test):
        under_test([sys.executable, "-c", {SLEEPS!r}])
        suspended()

    def test_without_real_time_fails_all_the_same():
        suspended()
        assert 1 == 2
"""


def test_a_failure_on_a_machine_that_was_late_is_invalid(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(SUSPENDED)
    result = pytester.runpytest_subprocess(*WORDS)
    result.assert_outcomes(passed=1, skipped=1, failed=1)
    result.stdout.fnmatch_lines(["*INVALID: this process was not run for 0.[5-9]*limit 0.1 s; it failed: *"])
    result.stdout.fnmatch_lines(["FAILED *test_without_real_time_fails_all_the_same*"])


def test_a_failure_counts_where_no_lateness_excuses_it(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(SUSPENDED)
    result = pytester.runpytest_subprocess(*WORDS, "--late-after=0", "-k", "fails_after")
    result.assert_outcomes(failed=1)


def test_a_watch_that_was_in_time_excuses_nothing() -> None:
    watch = HostWatch()
    watch.end()
    watch.worst_s = 0.05
    assert lateness(watch, [], 0.1) == ""
    watch.worst_s = 0.1
    assert lateness(watch, [], 0.1) == "this process was not run for 0.10 s, limit 0.1 s"
    assert lateness(watch, [], 0.0) == ""
