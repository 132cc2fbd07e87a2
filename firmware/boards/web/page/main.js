// Where it begins: a link that runs lines, or the whole page.

window.addEventListener('hashchange', () => {
  if (location.hash.startsWith(RUN)) {
    location.reload();
  }
});

const linked = textOfLink();
if (linked !== null) {
  runLines(linked).catch((error) => {
    element('run-state').textContent = `failed: ${error.message}`;
  });
} else {
  const app = new App();
  app.work(() => app.begin());
}
