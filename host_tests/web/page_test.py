"""What the tests of emax.html share: the page in a browser, as somebody would use it.

usage: test_NAME.py PROGRAM DATA_DIRECTORY EMAX.HTML "RUNNER... IMAGE" [unittest arguments]
"""

import json
import pathlib
import shlex
import sys
import time
import urllib.parse

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))

PAGE = pathlib.Path(sys.argv.pop(3)).resolve()
BOARD = shlex.split(sys.argv.pop(3))

from browser import Browser  # noqa: E402
from program_test import DATA, PROGRAM, ProgramTest, main  # noqa: E402, F401

LIMIT_S = 120.0  # Of a hang, on a loaded machine.


class PageTest(ProgramTest):
    """One browser for each test, with nothing kept in it yet."""

    def setUp(self):
        super().setUp()
        self.browser = Browser()
        self.addCleanup(self.browser.__exit__)

    def open(self, width: int = 1000) -> None:
        self.browser.open(PAGE, width)
        self.idle()

    def run_link(self, lines: str) -> str:
        self.browser.open(PAGE, fragment="#run=" + urllib.parse.quote(lines))
        self.wait_for("document.getElementById('run-state').textContent.startsWith('done')")
        return self.text("answers")

    def wait_for(self, expression: str) -> None:
        """The page may be loading itself again meanwhile: it is asked what it says only once it is too late."""
        deadline = time.monotonic() + LIMIT_S
        while not self.browser.evaluate(expression):
            if time.monotonic() > deadline:
                self.fail(f"{expression}; the page says: {self.text('problem')}")
            self.between_looks()

    def between_looks(self) -> None:
        time.sleep(0.02)

    def idle(self) -> None:
        self.wait_for("document.body.dataset.busy === 'no'")

    def text(self, element: str) -> str:
        return self.browser.evaluate(f"document.getElementById('{element}').textContent")

    def click(self, element: str) -> None:
        self.browser.evaluate(f"document.getElementById('{element}').click()")

    def click_at(self, stage: str, element: str) -> None:
        """Clicks in the page itself, at the first word of this stage: it may be over before anybody here has seen it."""
        self.browser.evaluate(
            "(() => { const stage = document.getElementById('stage'); const watch = new MutationObserver(() => {"
            f" if (stage.textContent.startsWith({json.dumps(stage)})) {{ watch.disconnect();"
            f" document.getElementById('{element}').click(); }} }});"
            " watch.observe(stage, {childList: true, characterData: true, subtree: true}); })()"
        )

    def fill(self, element: str, value: str) -> None:
        self.browser.evaluate(
            f"(() => {{ const field = document.getElementById('{element}'); field.value = {json.dumps(value)};"
            " field.dispatchEvent(new Event('change')); })()"
        )

    def submit(self, form: str) -> None:
        self.browser.evaluate(f"document.getElementById('{form}').requestSubmit()")

    def speak(self, line: str) -> list[str]:
        """A line at the page's console, and what it answers."""
        before = len(self.text("log"))
        self.fill("line", line)
        self.submit("speak")
        self.wait_for("document.getElementById('speak').getAttribute('aria-busy') === 'false'")
        return self.text("log")[before:].splitlines()[1:]

    def drop(self, *paths: pathlib.Path) -> None:
        self.browser.choose_files("#files", list(paths))
        self.browser.evaluate("new Promise((resolve) => setTimeout(resolve, 20))")
        self.idle()

    def saved(self, button: str) -> str:
        """What a button saves, caught before it becomes a file."""
        self.browser.evaluate(
            "(() => { const make = URL.createObjectURL; URL.createObjectURL = (blob) => { window.caught = blob; window.savedText = blob.text();"
            f" URL.createObjectURL = make; return '#'; }}; document.getElementById('{button}').click(); }})()"
        )
        return self.browser.evaluate("window.savedText")

    def results(self) -> dict:
        return json.loads(self.saved("save-json"))

    def assert_quiet(self) -> None:
        """No script has failed, nothing was violated, and nothing was asked for beyond the file itself."""
        self.assertEqual(self.browser.complaints(), [])
        for address in self.browser.requests():
            self.assertTrue(address.startswith(("blob:", PAGE.as_uri())) or address == "about:blank", address)
