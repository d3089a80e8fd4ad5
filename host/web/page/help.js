// Explanations behind a "?": one is open at a time, and Escape or a click elsewhere closes it.

const all = () => document.querySelectorAll("details.what[open]");

/** Closes the open explanation. Returns whether there was one. */
function close(but = null) {
  const open = [...all()].filter((one) => one !== but);
  for (const one of open) {
    one.open = false;
  }
  return open.length > 0;
}

addEventListener("click", ({ target }) => close(target.closest?.("details.what")));
addEventListener("keydown", (event) => {
  if (event.key === "Escape" && close()) {
    event.preventDefault();
  }
});
